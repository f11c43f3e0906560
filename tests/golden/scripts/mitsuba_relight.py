"""A torus on the ground under distant light, rendered by Mitsuba 3, as CSV on standard output.

How to run (from this folder; nothing but the packages `mitsuba` and `numpy` is needed):

    pip install mitsuba numpy
    python mitsuba_relight.py > ../data/mitsuba_relight.csv

It takes a few minutes. The mesh, the light and the camera are those of `relight.rs`.
"""

import math

import mitsuba as mi
import numpy as np

VARIANT = "scalar_rgb"
mi.set_variant(VARIANT)

SIZE, SAMPLES = 64, 4096
AROUND, TUBE = 96, 48
ETA, K, ALPHA = (0.2, 0.92, 1.1), (3.91, 2.45, 2.14), 0.4
EYE, FOV_DEG = (1.2, 3.0, 4.2), 40.0
GROUND_ALBEDO, GROUND_Y, GROUND_HALF = 0.35, -0.5, 8.0
# Radiance: (constant + slope * y + lobe * exp(SHARP * (w . toward - 1))) * min(5 y, 1), and none from below: there the
# ground would hide it from the torus, which here sees the whole map.
CONSTANT, SLOPE, LOBE = (0.2, 0.22, 0.25), (0.3, 0.4, 0.6), (6.0, 5.0, 3.5)
TOWARD, SHARP = (0.6, 0.64, 0.48), 30.0


def radiance(w):
    lobe = np.exp(SHARP * (w @ np.array(TOWARD) - 1.0))
    y = np.maximum(w[..., 1], 0.0)
    parts = [c + s * y + l * lobe for c, s, l in zip(CONSTANT, SLOPE, LOBE)]
    return np.stack(parts, axis=-1) * np.minimum(5.0 * y, 1.0)[..., None]


def environment(width=512, height=256):
    """Mitsuba's map starts at -z and goes on over +x."""
    theta = (np.arange(height) + 0.5) / height * math.pi
    phi = (np.arange(width) + 0.5) / width * 2.0 * math.pi
    theta, phi = np.meshgrid(theta, phi, indexing="ij")
    w = np.stack([np.sin(theta) * np.sin(phi), np.cos(theta), -np.sin(theta) * np.cos(phi)], -1)
    bitmap = mi.Bitmap(radiance(w).astype(np.float32))
    return {"type": "envmap", "bitmap": bitmap}


def torus():
    u, v = np.meshgrid(
        np.arange(AROUND + 1) / AROUND * 2.0 * math.pi,
        np.arange(TUBE + 1) / TUBE * 2.0 * math.pi,
        indexing="ij",
    )
    normals = np.stack([np.sin(u) * np.cos(v), np.sin(v), np.cos(u) * np.cos(v)], -1)
    positions = np.stack([np.sin(u), np.zeros_like(u), np.cos(u)], -1) + 0.5 * normals
    faces = []
    for i in range(AROUND):
        for j in range(TUBE):
            at = i * (TUBE + 1) + j
            across = at + TUBE + 1
            faces += [(at, across, across + 1), (at, across + 1, at + 1)]
    material = {
        "type": "roughconductor",
        "distribution": "ggx",
        "alpha": ALPHA,
        "eta": {"type": "rgb", "value": list(ETA)},
        "k": {"type": "rgb", "value": list(K)},
    }
    properties = mi.Properties()
    properties["bsdf"] = mi.load_dict(material)
    mesh = mi.Mesh(
        "torus", positions.size // 3, len(faces), has_vertex_normals=True, props=properties
    )
    params = mi.traverse(mesh)
    params["vertex_positions"] = positions.reshape(-1).tolist()
    params["vertex_normals"] = normals.reshape(-1).tolist()
    params["faces"] = np.array(faces, dtype=np.uint32).reshape(-1).tolist()
    params.update()
    return mesh


def main():
    transform = mi.ScalarTransform4f
    ground = transform().translate([0, GROUND_Y, 0]).rotate([1, 0, 0], -90).scale(GROUND_HALF)
    scene = mi.load_dict(
        {
            "type": "scene",
            "integrator": {"type": "direct", "hide_emitters": True},
            "light": environment(),
            "torus": torus(),
            "ground": {
                "type": "rectangle",
                "to_world": ground,
                "bsdf": {
                    "type": "diffuse",
                    "reflectance": {"type": "rgb", "value": [GROUND_ALBEDO] * 3},
                },
            },
            "camera": {
                "type": "perspective",
                "fov": FOV_DEG,
                "to_world": transform().look_at(origin=EYE, target=[0, 0, 0], up=[0, 1, 0]),
                "sampler": {"type": "stratified", "sample_count": SAMPLES},
                "film": {
                    "type": "hdrfilm",
                    "width": SIZE,
                    "height": SIZE,
                    "rfilter": {"type": "box"},
                    "pixel_format": "rgb",
                    "component_format": "float32",
                },
            },
        }
    )
    picture = np.array(mi.render(scene, seed=0))
    print(f"# Mitsuba {mi.__version__} (PyPI package `mitsuba`), variant {VARIANT}, direct light alone,")
    print(f"# {SIZE} x {SIZE} pixels of {SAMPLES} stratified samples and a box filter, linear RGB, row by row.")
    print("# Made by scripts/mitsuba_relight.py, which describes the scene; do not edit by hand.")
    print("r,g,b")
    for pixel in picture.reshape(-1, 3):
        print(",".join(f"{value:.4g}" for value in pixel))


if __name__ == "__main__":
    main()
