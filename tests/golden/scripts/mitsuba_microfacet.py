"""Reference BRDF values from Mitsuba 3, as CSV on standard output.

How to run (from this folder; nothing but the `mitsuba` package is needed):

    pip install mitsuba
    python mitsuba_microfacet.py > ../data/mitsuba_microfacet.csv

Every model is evaluated at the same 60 direction pairs. Next to Mitsuba's
numbers the script evaluates its own float64 closed forms,
D * G * F / (4 cos_i cos_o), with both the separable and the height-correlated
Smith G, and puts the largest relative differences into the comment lines.
"""

import cmath
import math
import random

import mitsuba as mi

VARIANT = "scalar_rgb"
mi.set_variant(VARIANT)

ETA, K = (0.2, 0.92, 1.1), (3.91, 2.45, 2.14)
COAT_IOR = 1.5
ALBEDO = (0.2, 0.5, 0.8)


def rgb(values):
    return {"type": "rgb", "value": list(values)}


def conductor(**roughness):
    return {"type": "roughconductor", "eta": rgb(ETA), "k": rgb(K), **roughness}


# name: (Mitsuba description, (distribution, alpha_x, alpha_y) or None)
MODELS = {
    "conductor_ggx": (conductor(distribution="ggx", alpha=0.3), ("ggx", 0.3, 0.3)),
    "conductor_ggx_aniso": (
        conductor(distribution="ggx", alpha_u=0.15, alpha_v=0.4),
        ("ggx", 0.15, 0.4),
    ),
    "conductor_beckmann": (
        conductor(distribution="beckmann", alpha=0.25),
        ("beckmann", 0.25, 0.25),
    ),
    "plastic_ggx": (
        {
            "type": "roughplastic",
            "distribution": "ggx",
            "alpha": 0.3,
            "int_ior": COAT_IOR,
            "ext_ior": 1.0,
            "diffuse_reflectance": rgb((0.0, 0.0, 0.0)),
            "nonlinear": False,
        },
        ("ggx", 0.3, 0.3),
    ),
    "diffuse": ({"type": "diffuse", "reflectance": rgb(ALBEDO)}, None),
}


# ---------------------------------------------------------------- directions


def direction_pairs():
    """60 tuples (theta_i, phi_i, theta_o, phi_o) in degrees.

    All angles are multiples of 1/64 degree, so they are exact in binary.
    """
    rng = random.Random(20)

    def angle(low, high):
        return rng.randint(round(low * 64), round(high * 64)) / 64.0

    def azimuth():
        return angle(0, 360 - 1 / 64)

    def near(theta, phi, spread):
        theta = min(85.0, max(0.0, theta + angle(-spread, spread)))
        return theta, (phi + 180.0 + angle(-spread, spread)) % 360.0

    pairs = [(0.0, 0.0, 0.0, 0.0)]
    # one of the two along the normal
    for theta in (5.0, 25.0, 50.0, 85.0):
        pairs.append((0.0, 0.0, theta, azimuth()))
    for theta in (15.0, 40.0, 70.0):
        pairs.append((theta, azimuth(), 0.0, 0.0))
    # exact mirror pairs
    for theta in (10.0, 30.0, 45.0, 60.0, 75.0, 85.0):
        phi = azimuth()
        pairs.append((theta, phi, theta, (phi + 180.0) % 360.0))
    # back towards the light
    for theta in (20.0, 40.0, 60.0, 80.0):
        phi = azimuth()
        pairs.append((theta, phi, theta, phi))
    # close to mirror
    for _ in range(16):
        theta, phi = angle(5, 70), azimuth()
        pairs.append((theta, phi, *near(theta, phi, 10)))
    # grazing: both sides near mirror, both sides free, one side only
    for _ in range(4):
        theta, phi = angle(75, 85), azimuth()
        pairs.append((theta, phi, *near(theta, phi, 6)))
    for _ in range(4):
        pairs.append((angle(75, 85), azimuth(), angle(75, 85), azimuth()))
    for _ in range(2):
        pairs.append((angle(75, 85), azimuth(), angle(0, 60), azimuth()))
        pairs.append((angle(0, 60), azimuth(), angle(75, 85), azimuth()))
    # anything
    while len(pairs) < 60:
        pairs.append((angle(0, 85), azimuth(), angle(0, 85), azimuth()))
    return pairs


def direction(theta_deg, phi_deg):
    theta, phi = math.radians(theta_deg), math.radians(phi_deg)
    return (
        math.sin(theta) * math.cos(phi),
        math.sin(theta) * math.sin(phi),
        math.cos(theta),
    )


def mitsuba_brdf(bsdf, wi, wo):
    """f_r in 1/sr: Mitsuba's value without the cosine of `wo` it includes."""
    si = mi.SurfaceInteraction3f()
    si.wi = mi.Vector3f(*wi)
    wo = mi.Vector3f(*wo)
    value = bsdf.eval(mi.BSDFContext(), si, wo)
    return [float(value[c]) / float(wo.z) for c in range(3)]


# --------------------------------------------------------------- closed forms


def fresnel(cos_theta, index):
    """Exact unpolarised reflectance, vacuum onto a (complex) index."""
    n2 = complex(index) ** 2
    root = cmath.sqrt(n2 - (1.0 - cos_theta**2))
    s = (cos_theta - root) / (cos_theta + root)
    p = (n2 * cos_theta - root) / (n2 * cos_theta + root)
    return 0.5 * (abs(s) ** 2 + abs(p) ** 2)


def smith_lambda(kind, v, ax, ay):
    """Smith's Lambda; 'beckmann_fit' is Walter's rational fit, as a Lambda."""
    slope2 = ((ax * v[0]) ** 2 + (ay * v[1]) ** 2) / v[2] ** 2
    if slope2 == 0.0:
        return 0.0
    if kind == "ggx":
        return 0.5 * (math.sqrt(1.0 + slope2) - 1.0)
    c = 1.0 / math.sqrt(slope2)
    if kind == "beckmann":
        tail = math.exp(-c * c) / (c * math.sqrt(math.pi))
        return 0.5 * (tail - math.erfc(c))
    if c >= 1.6:
        return 0.0
    return (1.0 - 1.259 * c + 0.396 * c * c) / (3.535 * c + 2.181 * c * c)


def closed_form(name, wi, wo, smith, correlated):
    if name == "diffuse":
        return [albedo / math.pi for albedo in ALBEDO]
    distribution, ax, ay = MODELS[name][1]
    h = [a + b for a, b in zip(wi, wo)]
    length = math.sqrt(sum(x * x for x in h))
    h = [x / length for x in h]
    cos_d = sum(a * b for a, b in zip(wi, h))

    q = (h[0] / ax) ** 2 + (h[1] / ay) ** 2
    if distribution == "ggx":
        d = 1.0 / (math.pi * ax * ay * (q + h[2] ** 2) ** 2)
    else:
        d = math.exp(-q / h[2] ** 2) / (math.pi * ax * ay * h[2] ** 4)

    li, lo = (smith_lambda(smith, v, ax, ay) for v in (wi, wo))
    g = 1.0 / (1.0 + li + lo) if correlated else 1.0 / ((1.0 + li) * (1.0 + lo))

    if name == "plastic_ggx":
        f = [fresnel(cos_d, COAT_IOR)] * 3
    else:
        f = [fresnel(cos_d, complex(n, k)) for n, k in zip(ETA, K)]
    return [d * g * x / (4.0 * wi[2] * wo[2]) for x in f]


def largest_difference(name, rows, smith="", correlated=False):
    """Largest |mitsuba / closed form - 1| over all values Mitsuba has not cut to 0."""
    worst = 0.0
    for wi, wo, values in rows:
        for ours, theirs in zip(closed_form(name, wi, wo, smith, correlated), values):
            if theirs != 0.0:
                worst = max(worst, abs(theirs / ours - 1.0))
    return worst


def report(name, rows):
    if name == "diffuse":
        yield f"{name}, reflectance / pi: {largest_difference(name, rows):.2g}"
        return
    distribution = MODELS[name][1][0]
    forms = {"ggx": "Lambda exact"}
    if distribution == "beckmann":
        forms = {"beckmann_fit": "Lambda of Walter's fit", "beckmann": "Lambda exact"}
    for smith, label in forms.items():
        for correlated, g in ((False, "separable"), (True, "height-correlated")):
            worst = largest_difference(name, rows, smith, correlated)
            yield f"{name}, {label}, {g} G: {worst:.2g}"


# --------------------------------------------------------------------- output

ABOUT = f"""\
Reference BRDF values from Mitsuba {mi.__version__} (PyPI package `mitsuba`), variant {VARIANT}.
Made by scripts/mitsuba_microfacet.py; do not edit by hand.

Models, all in vacuum, tangent frame x = u, y = v, z = normal:
  conductor_ggx        roughconductor, ggx, alpha 0.3, eta {ETA}, k {K}
  conductor_ggx_aniso  roughconductor, ggx, alpha_u 0.15 (along x), alpha_v 0.4 (along y), same eta and k
  conductor_beckmann   roughconductor, beckmann, alpha 0.25, same eta and k
  plastic_ggx          roughplastic, ggx, alpha 0.3, int_ior {COAT_IOR}, ext_ior 1, diffuse_reflectance 0,
                       nonlinear false: only the specular coat is left
  diffuse              diffuse, reflectance {ALBEDO}

Columns: r, g, b are plain f_r in 1/sr. Mitsuba's eval() includes the cosine of its argument wo, the
direction (theta_o, phi_o); it has been divided out. Mitsuba's si.wi is (theta_i, phi_i). Both
directions point away from the surface: (sin theta cos phi, sin theta sin phi, cos theta).
The angles are multiples of 1/64 degree and printed exactly. The directions are built in float64 and
rounded to float32 for Mitsuba, whose arithmetic here is float32 (the package has no double variant).
The 60 direction pairs are the same for every model: normal incidence, exact mirror, back towards the
light, near mirror, grazing (75 to 85 degrees), anything up to 85 degrees.

Masking-shadowing: separable Smith, G1(wi) * G1(wo), in every microfacet model, not height-correlated.
For beckmann, G1 is the rational fit of Walter et al. 2007 (G1 = 1 where 1 / (alpha tan theta) >= 1.6).
Fresnel: exact unpolarised reflectance at the angle between wi and the half vector, of the complex
index eta + i k per channel (conductors) or of the real index {COAT_IOR} (plastic).
Mitsuba sets D to 0 where D(h) * cos(theta_h) <= 1e-20; such rows are 0 here and are left out below."""


def main():
    pairs = direction_pairs()
    results = {}
    for name, (description, _) in MODELS.items():
        bsdf = mi.load_dict(description)
        results[name] = []
        for pair in pairs:
            wi, wo = direction(*pair[:2]), direction(*pair[2:])
            results[name].append((wi, wo, mitsuba_brdf(bsdf, wi, wo)))

    lines = ABOUT.splitlines()
    lines += ["", "Largest relative difference from float64 closed forms, D G F / (4 cos_i cos_o):"]
    for name, rows in results.items():
        lines += ["  " + line for line in report(name, rows)]
        zeros = sum(not any(values) for _, _, values in rows)
        if zeros:
            lines.append(f"  ({name}: {zeros} of {len(rows)} rows are 0)")
    for line in lines:
        print(f"# {line}".rstrip())

    print("model,theta_i_deg,phi_i_deg,theta_o_deg,phi_o_deg,r,g,b")
    for name, rows in results.items():
        for pair, (_, _, values) in zip(pairs, rows):
            numbers = [f"{a:.17g}" for a in pair] + [f"{v:.9g}" for v in values]
            print(",".join([name] + numbers))


if __name__ == "__main__":
    main()
