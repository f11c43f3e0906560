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
            self.tensors = {name: file.get_tensor(name).astype(float) for name in file.keys()}

    def evaluate(self, wi, wo, textures=None):
        """Reflectance in 1/sr, shape [n, 1 or 3], at unit directions of shape [n, 3], z = normal."""
        kind = self.record["kind"]
        if kind == "factored":
            value = product_of_textures(self.record, self.tensors, wi, wo, textures)
        elif kind == "separable":
            value = sum_of_products(self.record, self.tensors, wi, wo)
        else:
            raise ValueError(f"a file of kind {kind!r}, which is no model of `brdf factor`")
        lit = (wi[:, 2:] > 0) & (wo[:, 2:] > 0)
        return np.where(lit, np.maximum(value, 0), 0)


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
    return np.stack(channels, axis=1)


def pulled_back(w, theta_max):
    """Directions beyond the grazing limit, brought back to it along their azimuth."""
    radius = np.hypot(w[:, 0], w[:, 1])
    scale = np.sin(theta_max) / np.where(radius > 0, radius, 1)
    limit = np.stack([scale * w[:, 0], scale * w[:, 1], np.full(len(w), np.cos(theta_max))], axis=1)
    return np.where(w[:, 2:] >= np.cos(theta_max), w, limit)


def read_factor(texture, factor, coordinate, wi, wo):
    """The log value, [n, channels], that one texture gives at one of its coordinates."""
    size, kind = factor["grid"]["size"], coordinate["kind"]
    if factor["grid"]["dimensions"] == 1:
        w = {"radial-wi": wi, "radial-wo": wo}.get(kind)
        w = half_vector(wi, wo) if w is None else w
        x = np.hypot(w[:, 0], w[:, 1]) / factor["extent"][0]
        i, next_i, u = between(x * (size - 1), size)
        return (1 - u[:, None]) * texture[i] + u[:, None] * texture[next_i]
    x, y = (plane_point(coordinate, wi, wo) / factor["extent"]).T
    columns, rows = (between((v + 1) / 2 * (size - 1), size) for v in (x, y))
    return bilinear(texture, columns, rows)


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
