"""Evaluates a model that `brdf factor` wrote, with NumPy and safetensors alone.

    python3 evaluate_model.py model.safetensors pairs.csv [--textures N]

prints r,g,b in 1/sr for every row of a table whose header names theta_i_deg, phi_i_deg, theta_o_deg and
phi_o_deg. --textures takes the model of N textures of a search instead of the largest. model-file.md has the
formulas.
"""

import argparse
import csv
import json

import numpy as np
from safetensors import safe_open


class Model:
    """A model file: the record, and the tensors in double precision."""

    def __init__(self, path):
        with safe_open(path, "np") as file:
            self.record = json.loads(file.metadata()["brdf"])
            tensors = {name: file.get_tensor(name) for name in file.keys()}
        self.tensors = {name: in_doubles(name, tensors) for name in tensors}
        if self.record["kind"] == "spline":
            self.splines = Splines(tensors["stream"].tobytes())

    def evaluate(self, wi, wo, textures=None):
        """Reflectance in 1/sr, shape [n, 1 or 3], at unit directions of shape [n, 3], z = normal."""
        kind = self.record["kind"]
        if kind == "factored":
            value = product_of_textures(self.record, self.tensors, wi, wo, textures)
        elif kind == "separable":
            value = sum_of_products(self.record, self.tensors, wi, wo)
        elif kind == "spline":
            value = self.splines.evaluate(wi, wo)
        elif kind == "ggx":
            value = ggx_lobes(self.record["fit"]["makeup"]["lobes"], wi, wo)
        else:
            raise ValueError(f"a file of kind {kind!r}, which is no model of `brdf factor`")
        lit = (wi[:, 2:] > 0) & (wo[:, 2:] > 0)
        return np.where(lit, np.maximum(value, 0), 0)


def in_doubles(name, tensors):
    """A tensor in double precision. Eight bits are even steps from the low to the high end of a channel's range."""
    tensor, ends = tensors[name], tensors.get(f"{name}.range")
    if tensor.dtype != np.uint8 or ends is None:
        return tensor.astype(float)
    low, high = ends.astype(float).T
    return (low + (high - low) * (tensor / 255)).astype(np.float32).astype(float)


# Directions


def half_vector(wi, wo):
    total = wi + wo
    length = np.linalg.norm(total, axis=1, keepdims=True)
    return np.where(length > 0, total / np.where(length > 0, length, 1), [0, 0, 1])


def kautz_mccool_difference(wi, h):
    """wi in the frame (t, b, h), where t = normalize(x - h h_x) and b = h x t = normalize(h x x)."""
    length = np.hypot(h[:, 1], h[:, 2])
    safe = np.where(length > 0, length, 1)
    b = np.stack([0 * safe, np.where(length > 0, h[:, 2] / safe, 1), -h[:, 1] / safe], axis=1)
    t = np.cross(b, h)
    return np.stack([np.sum(axis * wi, axis=1) for axis in (t, b, h)], axis=1)


def turned_back(w, by):
    """w turned about the normal by minus the azimuth of `by`."""
    radius = np.hypot(by[:, 0], by[:, 1])
    safe = np.where(radius > 0, radius, 1)
    cos, sin = np.where(radius > 0, by[:, 0] / safe, 1), by[:, 1] / safe
    x, y, z = w.T
    return np.stack([cos * x + sin * y, cos * y - sin * x, z], axis=1)


def rusinkiewicz_difference(wi, h):
    """wi turned about the normal by -phi_h, then about y by -theta_h."""
    x, y, z = turned_back(wi, h).T
    sin, cos = np.hypot(h[:, 0], h[:, 1]), h[:, 2]
    return np.stack([cos * x - sin * z, y, sin * x + cos * z], axis=1)


def lifted(x, y):
    """The point of the hemisphere above a point of the unit disc."""
    return np.stack([x, y, np.sqrt(np.maximum(1 - x * x - y * y, 0))], axis=1)


def parabolic(w):
    return w[:, :2] / (1 + w[:, 2:])


# Textures


def between(position, count):
    """The texel below a position in texels, the next one, and the share of the next; clamped to the rim."""
    position = np.clip(position, 0, count - 1)
    low = np.minimum(position.astype(int), max(count - 2, 0))
    return low, np.minimum(low + 1, count - 1), position - low


def between_around(position, count):
    """The same on an axis that wraps around."""
    low = np.floor(position)
    first = low.astype(int) % count
    return first, (first + 1) % count, position - low


def bilinear(texture, columns, rows):
    """Reads [row, column, ...] between four texels."""
    (j, next_j, u), (i, next_i, v) = columns, rows
    u, v = (share.reshape(-1, *[1] * (texture.ndim - 2)) for share in (u, v))
    upper = (1 - u) * texture[i, j] + u * texture[i, next_j]
    lower = (1 - u) * texture[next_i, j] + u * texture[next_i, next_j]
    return (1 - v) * upper + v * lower


# Products of textures


def product_of_textures(record, tensors, wi, wo, textures=None):
    factors, prefix = record["factors"], ""
    if textures not in (None, len(factors)):
        factors = next(part for part in record["smaller"] if len(part) == textures)
        prefix = f"of{textures}."
    wi, wo = (pulled_back(w, record["theta_max"]) for w in (wi, wo))
    log = 0
    for index, factor in enumerate(factors):
        texture = tensors[f"{prefix}factor{index}"]
        for coordinate in factor["coordinates"]:
            log = log + read_factor(texture, factor, coordinate, wi, wo)
    channels = [inverse_log(map, log[:, c]) for c, map in enumerate(record["maps"])]
    values = np.stack(channels, axis=1)
    return np.minimum(values, record["ceilings"]) if "ceilings" in record else values


def pulled_back(w, theta_max):
    """Directions beyond the grazing limit, brought back to it along their azimuth."""
    radius = np.hypot(w[:, 0], w[:, 1])
    scale = np.sin(theta_max) / np.where(radius > 0, radius, 1)
    limit = np.stack([scale * w[:, 0], scale * w[:, 1], np.full(len(w), np.cos(theta_max))], axis=1)
    return np.where(w[:, 2:] >= np.cos(theta_max), w, limit)


def read_factor(texture, factor, coordinate, wi, wo):
    """The log value, [n, channels], that one texture gives at one of its coordinates."""
    across, down = factor["grid"]["columns"], factor["grid"]["rows"]
    kind = coordinate["kind"]
    if down == 1:
        w = {"radial-wi": wi, "radial-wo": wo}.get(kind)
        w = half_vector(wi, wo) if w is None else w
        x = np.hypot(w[:, 0], w[:, 1]) / factor["extent"][0]
        i, next_i, u = between(x * (across - 1), across)
        return (1 - u[:, None]) * texture[i] + u[:, None] * texture[next_i]
    if kind == "isotropic":
        pair = (wo, wi) if coordinate.get("swapped") else (wi, wo)
        place = [
            spaced(axis, angle_of(axis["angle"], *pair), largest)
            for axis, largest in zip(coordinate["axes"], factor["extent"])
        ]
    else:
        place = (plane_point(coordinate, wi, wo) / factor["extent"]).T
    columns, rows = (between((v + 1) / 2 * (n - 1), n) for v, n in zip(place, (across, down)))
    return bilinear(texture, columns, rows)


def angle_of(angle, wi, wo):
    """An angle that a turn about the normal does not change."""
    if angle in ("theta-i", "theta-o"):
        w = wi if angle == "theta-i" else wo
        return np.arctan2(np.hypot(w[:, 0], w[:, 1]), w[:, 2])
    if angle == "delta-phi":
        side = np.abs(wi[:, 0] * wo[:, 1] - wi[:, 1] * wo[:, 0])
        apart = np.arctan2(side, wi[:, 0] * wo[:, 0] + wi[:, 1] * wo[:, 1])
        shorter = np.minimum(np.hypot(wi[:, 0], wi[:, 1]), np.hypot(wo[:, 0], wo[:, 1]))
        return np.where(shorter > 1e-4, apart, 0)
    s, t = wi + wo, wi - wo
    across, length = np.hypot(s[:, 0], s[:, 1]), np.linalg.norm(s, axis=1)
    theta_d = np.arctan2(np.linalg.norm(t, axis=1), length)
    if angle == "theta-h":
        return np.arctan2(across, s[:, 2])
    if angle == "theta-d":
        return theta_d
    safe = np.where(across > 0, across, 1)
    along = (s[:, 0] * t[:, 0] + s[:, 1] * t[:, 1]) / safe * s[:, 2] - t[:, 2] * across
    beside = (s[:, 0] * t[:, 1] - s[:, 1] * t[:, 0]) / safe * length
    known = (across > 1e-4 * length) & (np.linalg.norm(t, axis=1) > 1e-4 * length)
    phi_d = np.where(known, np.arctan2(beside, along), 0)
    size = np.abs(phi_d)
    return {
        "phi-d": size,
        "phi-d-mod-pi": np.mod(phi_d, np.pi),
        "phi-d-folded": np.minimum(size, np.pi - size),
        "difference-x": theta_d * np.cos(phi_d),
        "difference-x-folded": np.abs(theta_d * np.cos(phi_d)),
        "difference-y": theta_d * np.sin(phi_d),
        "difference-y-folded": np.abs(theta_d * np.sin(phi_d)),
    }[angle]


def spaced(axis, angle, largest):
    """An angle as a texture coordinate, [-1, 1]."""
    if axis["angle"] in ("difference-x", "difference-y"):
        return angle / largest
    spacing = axis.get("spacing", {"kind": "linear"})
    return -1 + 2 * {
        "linear": lambda: angle / largest,
        "power": lambda: (angle / largest) ** spacing["exponent"],
        "asinh": lambda: np.arcsinh(angle / spacing["alpha"]) / np.arcsinh(largest / spacing["alpha"]),
    }[spacing["kind"]]()


def plane_point(coordinate, wi, wo):
    """A two-dimensional coordinate before it is divided by the extent."""
    h = half_vector(wi, wo)
    kind = coordinate["kind"]
    if kind != "projected":
        w = {"wi": wi, "wo": wo, "h": h, "d": kautz_mccool_difference(wi, h)}[kind]
        return parabolic(w)
    if coordinate["space"] == "standard":
        first, second = wi, wo
    else:
        first, second = h, kautz_mccool_difference(wi, h)
    four = np.concatenate([parabolic(first), parabolic(second)], axis=1)
    return four @ np.array(coordinate["projection"]).T


def inverse_log(map, log):
    kind = map["map"]
    if kind == "zero":
        return 0 * log
    return {
        "offset": lambda: np.exp(log) - map["a"],
        "log": lambda: np.exp(log),
        "highlight": lambda: map["a"] - np.exp(log),
    }[kind]()


# Sums of products


def sum_of_products(record, tensors, wi, wo):
    layout = record["layout"]
    a, b = two_points(layout, wi, wo)
    g = read_chart(tensors["first"], layout["first"], a)
    if "second" in tensors:
        h = read_chart(tensors["second"], layout["second"], b)
    else:
        h = read_chart(tensors["first"], layout["first"], b) * tensors["signs"]
    total = np.sum(g * h, axis=1)  # [n, term, channel]; one channel of g serves all of h
    maps = record["maps"]
    return np.stack([inverse_map(m, total[:, c], wi[:, 2]) for c, m in enumerate(maps)], axis=1)


def two_points(layout, wi, wo):
    """The two points of the hemisphere at which the textures of both sides are read."""
    parametrization = layout["parametrization"]
    isotropic = layout["first"]["chart"] in ("radius", "merl-theta-h")
    a, b = hemisphere_points(parametrization, wi, wo, isotropic)
    if isotropic:
        # These carry the azimuth of the first point; the others are free of it already.
        if parametrization in ("standard", "orthographic", "hybrid"):
            b = turned_back(b, a)
        # On the normal there is no azimuth that could lie between the two.
        on_normal = np.hypot(a[:, 0], a[:, 1]) <= 1e-12
        along_x = np.stack([np.hypot(b[:, 0], b[:, 1]), 0 * b[:, 0], b[:, 2]], axis=1)
        b = np.where(on_normal[:, None], along_x, b)
        a = turned_back(a, a)
    return a, b


def hemisphere_points(parametrization, wi, wo, isotropic):
    h = half_vector(wi, wo)
    if parametrization == "standard":
        return wi, wo
    if parametrization == "half-difference" or (parametrization == "kautz-mccool" and isotropic):
        return h, rusinkiewicz_difference(wi, h)
    if parametrization == "kautz-mccool":
        return h, kautz_mccool_difference(wi, h)
    if parametrization == "onion-slice":
        return wo, turned_back(wi, wo)
    middle, back = (wi + wo) / 2, (wi - wo) / 2
    x, y = back[:, 0], back[:, 1]
    if parametrization == "hybrid":
        across, length = np.hypot(x, y), np.linalg.norm(back, axis=1)
        safe = np.where(across > 0, across, 1)
        x, y = length * np.where(across > 0, x / safe, 1), length * y / safe
    elif parametrization != "orthographic":
        raise ValueError(f"unknown parametrization {parametrization!r}")
    return lifted(middle[:, 0], middle[:, 1]), lifted(x, y)


def read_chart(texture, chart, w):
    """Reads [row, column, term, channel] at directions w."""
    rows, columns = texture.shape[:2]
    kind = chart["chart"]
    theta = np.arctan2(np.hypot(w[:, 0], w[:, 1]), w[:, 2]) / (np.pi / 2)  # share of a right angle
    turn = np.arctan2(w[:, 1], w[:, 0]) / (2 * np.pi)  # share of a turn, -1/2 to 1/2
    only_row = (np.zeros(len(w), int), np.zeros(len(w), int), np.zeros(len(w)))
    if kind in ("merl-theta-h", "merl-theta-d-phi-d"):
        shift = {"centre": 0.5, "edge": 0.0}[chart["nodes"]]
        if kind == "merl-theta-h":
            return bilinear(texture, between(np.sqrt(theta) * columns - shift, columns), only_row)
        half_turn = np.where(turn < 0, 2 * turn + 1, 2 * turn)
        along = between_around(half_turn * columns - shift, columns)
        return bilinear(texture, along, between(theta * rows - shift, rows))
    x, y = {
        "parabolic": lambda: parabolic(w).T,
        "orthographic-disc": lambda: w[:, :2].T,
        "polar": lambda: (turn, np.hypot(*w[:, :2].T) / np.sqrt(1 + w[:, 2])),  # sqrt(1 - z), to all digits
        "spherical": lambda: (turn, theta),
    }[chart["map"]]()
    is_disc = chart["map"] in ("parabolic", "orthographic-disc")
    if kind == "radius":
        radius = np.hypot(x, y) if is_disc else y
        return bilinear(texture, between(radius * columns - 0.5, columns), only_row)
    if is_disc:
        along, across = ((v + 1) / 2 for v in (x, y))
        return bilinear(
            texture, between(along * columns - 0.5, columns), between(across * rows - 0.5, rows)
        )
    return bilinear(
        texture, between_around((x + 0.5) * columns - 0.5, columns), between(y * rows - 0.5, rows)
    )


def inverse_map(map, value, cos_theta_i):
    return {
        "linear": lambda: value,
        "offset": lambda: np.exp(value) - map["a"],
        "cosine": lambda: np.expm1(value) / np.maximum(cos_theta_i, 0.02),
    }[map["map"]]()


# Splines

SYMMETRIES = ("none", "mirror", "reciprocal", "both")
GROUPS, SIZES, DIGITS = 3, 14, 24
HALF_NODES = 512


class Splines:
    """A stream: its head, the coefficients, and the two tables that follow from them."""

    def __init__(self, stream):
        kind, self.terms, self.half_count, self.difference_count, self.order = stream[:5]
        if kind >> 6 != 1:
            raise ValueError(f"a stream of version {kind >> 6}, not 1")
        self.symmetry = SYMMETRIES[kind & 3]
        self.channels = 3 if kind & 4 else 1
        self.period = {"none": 2 * np.pi, "both": np.pi / 2}.get(self.symmetry, np.pi)
        rest = 17 + 12 * self.channels
        numbers = np.frombuffer(stream[5:rest], "<f4").astype(float)
        self.alpha, self.half_step, self.difference_step = numbers[:3]
        self.offset, self.least, self.most = numbers[3:].reshape(-1, 3).T
        lobes = kind >> 3 & 7
        length = 2 * self.channels + lobes * (self.channels + 2) if lobes else 0
        self.base = self.read_base(np.frombuffer(stream[rest : rest + 4 * length], "<f4").astype(float))
        rest += 4 * length
        self.exponents = np.frombuffer(stream[rest : rest + self.terms], np.int8).astype(float)
        self.harmonics = harmonics(self.symmetry, self.order)
        self.read_coefficients(Integers(stream[rest + self.terms :]))
        self.make_tables()

    def read_base(self, numbers):
        """Lobes as a record has them; of one channel, in all three."""
        if not len(numbers):
            return None
        n = self.channels
        colour = lambda values: dict(zip("rgb", np.broadcast_to(values, 3)))
        lobe = lambda values: {"f0": colour(values[:n]), "f90": values[n], "alpha": values[n + 1]}
        return {
            "diffuse": colour(numbers[:n]),
            "sheen": colour(numbers[n : 2 * n]),
            "lobes": [lobe(values) for values in numbers[2 * n :].reshape(-1, n + 2)],
        }

    def read_coefficients(self, integers):
        """half [term, spline], difference [term, spline, harmonic, channel]."""
        half = np.array([integers.line(0, self.half_count, None)[0] for _ in range(self.terms)], float)
        self.half = half * (self.half_step * 2 ** (-self.exponents / 4))[:, None]

        difference = []
        above = [None] * self.channels
        for _ in range(self.terms):
            lines = []
            for _ in self.harmonics:
                found = [
                    integers.line(min(colour, 1) + 1, self.difference_count, above[colour])
                    for colour in range(self.channels)
                ]
                lines.append([values for values, _ in found])
                above = [rests for _, rests in found]
                if len(lines) == 1:
                    first = above
            difference.append(lines)
            above = first  # the next term's first line follows this term's first
        # From [term, harmonic, colour, spline].
        difference = np.array(difference, float).transpose(0, 3, 1, 2)
        peaks = (np.arange(self.difference_count) - 1) / (self.difference_count - 3)
        sine = np.sin(difference_angle(peaks))
        envelope = np.stack([sine**order for order, _ in self.harmonics], axis=1)
        steps = self.difference_step / np.maximum(envelope, 1 / 8)
        self.difference = from_opponent(difference * steps[None, :, :, None])

    def make_tables(self):
        """half_table [node, term], difference_table [row, column, term, channel]; the last column is the mean."""
        at, weights = half_taps(np.linspace(0, 1, HALF_NODES), self.half_count)
        self.half_table = np.einsum("nt,knt->nk", weights, self.half[:, at]).astype(np.float32)

        rows = 3 * self.difference_count
        quarters = self.order * round(self.period / (np.pi / 2))
        columns = max(3 * quarters, 8) + 1
        at, weights = difference_taps(np.linspace(0, 1, rows), self.difference_count)
        over_theta = np.einsum("nt,kntmc->nkmc", weights, self.difference[:, at])
        sine = np.sin(difference_angle(np.linspace(0, 1, rows)))
        phi = self.period * np.linspace(0, 1, columns)
        angular = np.zeros((columns + 1, len(self.harmonics)))
        for m, (order, is_sine) in enumerate(self.harmonics):
            over_theta[:, :, m] *= (sine**order)[:, None, None]
            angular[:columns, m] = np.sin(order * phi) if is_sine else np.cos(order * phi)
        angular[columns, 0] = 1  # only the harmonic of order 0 has a mean
        self.difference_table = np.einsum("nkmc,jm->njkc", over_theta, angular).astype(np.float32)

    def evaluate(self, wi, wo):
        wi, wo = (pulled_back(w, np.arccos(0.05)) for w in (wi, wo))
        h = half_vector(wi, wo)
        theta_h, _ = polar_and_azimuth(h)
        theta_d, phi_d = polar_and_azimuth(rusinkiewicz_difference(wi, h))
        rows, columns = self.difference_table.shape[:2]
        columns -= 1
        place = np.arcsinh(theta_h / self.alpha) / np.arcsinh(np.pi / 2 / self.alpha)
        node, next_node, u = between(place * (HALF_NODES - 1), HALF_NODES)
        g = (1 - u[:, None]) * self.half_table[node] + u[:, None] * self.half_table[next_node]

        row = between(difference_axis(theta_d) * (rows - 1), rows)
        column = between(self.fold(phi_d) / self.period * (columns - 1), columns)
        value = bilinear(self.difference_table[:, :columns], column, row)
        i, next_i, v = row
        v = v[:, None, None]
        mean = (1 - v) * self.difference_table[i, columns] + v * self.difference_table[next_i, columns]
        known = np.minimum(theta_h / 1e-5, 1)[:, None, None]
        y = np.einsum("nk,nkc->nc", g, known * value + (1 - known) * mean)
        factor = 1
        if self.base:
            factor = self.offset + ggx_lobes(self.base, wi, wo)[:, : self.channels]
        return np.clip(factor * np.exp(y) - self.offset, self.least, self.most)

    def fold(self, phi):
        """phi_d in (-pi, pi], brought to the range from 0 to the period."""
        if self.symmetry == "none":
            return np.where(phi < 0, phi + 2 * np.pi, phi)
        if self.symmetry == "mirror":
            return np.abs(phi)
        if self.symmetry == "reciprocal":
            return np.where(phi < 0, phi + np.pi, phi)
        return np.minimum(np.abs(phi), np.pi - np.abs(phi))


def harmonics(symmetry, order):
    """Every harmonic as its order and whether it is the sine."""
    found = []
    for m in range(0, order + 1, 2 if symmetry in ("reciprocal", "both") else 1):
        found.append((m, False))
        if m > 0 and symmetry in ("none", "reciprocal"):
            found.append((m, True))
    return found


def polar_and_azimuth(w):
    x, y, z = w.T
    return np.arctan2(np.hypot(x, y), z), np.where((x == 0) & (y == 0), 0, np.arctan2(y, x))


def difference_axis(theta_d):
    return np.clip(np.tan(theta_d / 2), 0, 1) ** 1.5


def difference_angle(place):
    return 2 * np.arctan(np.cbrt(np.clip(place, 0, 1)) ** 2)


def cubic_taps(x, intervals):
    """The first of four cubic B-splines that are not 0 at x in [0, 1], and what they are there."""
    scaled = x * intervals
    first = np.minimum(scaled.astype(int), intervals - 1)
    t = scaled - first
    weights = [(1 - t) ** 3, 3 * t**3 - 6 * t**2 + 4, -3 * t**3 + 3 * t**2 + 3 * t + 1, t**3]
    return first, np.stack(weights, axis=1) / 6


def half_taps(x, count):
    """Splines even about 0: coefficient 1 stands in for the one before coefficient 0."""
    first, weights = cubic_taps(x, count - 2)
    return np.abs(first[:, None] + np.arange(4) - 1), weights


def difference_taps(x, count):
    first, weights = cubic_taps(x, count - 3)
    return first[:, None] + np.arange(4), weights


def from_opponent(colours):
    """The last axis from (r + g + b) / sqrt 3, (r - b) / sqrt 2 and (r - 2 g + b) / sqrt 6 to r, g, b."""
    if colours.shape[-1] == 1:
        return colours
    a, b, c = (colours[..., i] / np.sqrt(n) for i, n in enumerate((3, 2, 6)))
    return np.stack([a + b + c, a - 2 * c, a - b + c], axis=-1)


class Probability:
    """That a bit is 0, in 1/65536, and the number of bits it was learnt from."""

    def __init__(self):
        self.zero, self.seen = 1 << 15, 0

    def learn(self, bit):
        change = 2 * ((64 if bit else 65536 - 64) - self.zero)
        share = abs(change) // (2 * self.seen + 3)  # rounded towards 0
        self.zero += share if change > 0 else -share
        self.seen = min(self.seen + 1, 60)


class Magnitudes:
    """Probabilities of integers of similar size."""

    def __init__(self):
        self.more = [Probability() for _ in range(DIGITS)]
        self.second = [Probability() for _ in range(DIGITS)]
        self.sign = Probability()


class Integers:
    """Takes lines of integers out of a stream, bit by bit."""

    def __init__(self, stream):
        self.bytes, self.code, self.range = iter(stream), 0, 0xFFFFFFFF
        for _ in range(4):
            self.shift_in()
        self.magnitudes = [[Magnitudes() for _ in range(SIZES)] for _ in range(GROUPS)]
        self.guesses = [[Probability() for _ in range(2)] for _ in range(GROUPS)]

    def shift_in(self):
        self.code = (self.code << 8 | next(self.bytes, 0)) & 0xFFFFFFFF

    def bit(self, probability):
        bound = (self.range >> 16) * probability.zero
        bit = self.code >= bound
        if bit:
            self.code -= bound
            self.range -= bound
        else:
            self.range = bound
        probability.learn(bit)
        while self.range < 1 << 24:
            self.range <<= 8
            self.shift_in()
        return int(bit)

    def integer(self, models):
        digits = 0
        while digits < DIGITS and self.bit(models.more[digits]):
            digits += 1
        if digits == 0:
            return 0
        magnitude = 1
        for digit in range(digits - 1):
            probability = models.second[digits - 1] if digit == 0 else Probability()
            magnitude = 2 * magnitude + self.bit(probability)
        return -magnitude if self.bit(models.sign) else magnitude

    def line(self, group, count, above):
        """A line of integers, and what guesses left of them; `above` is what they left of another line."""
        kinds = self.guesses[group]
        kind = self.bit(kinds[0]) and 1 + self.bit(kinds[1])
        values, rests = [], []
        for at in range(count):
            last = values[-1] if values else 0
            before = values[-2] if at > 1 else last
            guess = (0, last, 2 * last - before)[kind]
            models = self.magnitudes[group][size_class(rests, above, at)]
            rests.append(self.integer(models))
            values.append(guess + rests[-1])
        return values, rests


def size_class(rests, above, at):
    """The class of an integer, by the integers near it."""
    near = [(3, rests[-1:]), (1, rests[-2:-1])]
    if above is not None:
        near += [(3, above[at : at + 1]), (1, above[at + 1 : at + 2])]
    weight = sum(weight for weight, value in near if value)
    if weight == 0:
        return SIZES - 1
    total = sum(weight * abs(value[0]) for weight, value in near if value)
    return min((2 * total // weight).bit_length(), SIZES - 2)


# GGX lobes


def ggx_lobes(makeup, wi, wo):
    h = half_vector(wi, wo)
    sine_sq, cos_h = h[:, 0] ** 2 + h[:, 1] ** 2, h[:, 2]
    zi, zo = wi[:, 2], wo[:, 2]
    fifth = (1 - np.clip(np.sum(h * wi, axis=1), 0, 1)) ** 5
    value = rgb(makeup["diffuse"]) / np.pi + fifth[:, None] * rgb(makeup["sheen"])
    for lobe in makeup["lobes"]:
        square = lobe["alpha"] ** 2
        distribution = 1 / (np.pi * square * (sine_sq / square + cos_h**2) ** 2)
        # G over 4 cos cos. Below the horizon, where the value is 0, it could be anything.
        ri, ro = (np.sqrt(square + (1 - square) * z * z) for z in (zi, zo))
        below = (zi <= 0) | (zo <= 0)
        visibility = 0.5 / np.where(below, 1, zo * ri + zi * ro)
        fresnel = rgb(lobe["f0"]) * (1 - fifth[:, None]) + lobe["f90"] * fifth[:, None]
        value = value + fresnel * (distribution * visibility)[:, None]
    return value


def rgb(value):
    return np.array([value[c] for c in "rgb"])


# The command


def read_pairs(path):
    """Unit directions to light and viewer, [n, 3] each."""
    with open(path, newline="") as file:
        rows = list(csv.DictReader(file))

    def directions(end):
        theta, phi = (np.radians([float(row[f"{a}_{end}_deg"]) for row in rows]) for a in ("theta", "phi"))
        return np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=1)

    return directions("i"), directions("o")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("model")
    parser.add_argument("pairs")
    parser.add_argument("--textures", type=int)
    arguments = parser.parse_args()
    value = Model(arguments.model).evaluate(*read_pairs(arguments.pairs), arguments.textures)
    print("r,g,b")
    for row in np.broadcast_to(value, (len(value), 3)):
        print(",".join(repr(float(v)) for v in row))


if __name__ == "__main__":
    main()
