"""Mitsuba 3's picture of three squares under a normal map, the reference for tests/mitsuba.rs.

Writes normal_map.json beside this file, whose fields pictures.py explains, and normal_map.png, the map: 16 bits per
channel, 8 x 8 normals by a formula, tilted by up to 30 degrees. The rest of the scene is normal_map.toml and normal_map.obj.
Box filter, one scattering event, independent samples.

Mitsuba's `normalmap` drops light on the wrong side of the surface as we do. In three things it differs, and the scene
avoids them. Its shadowing of light that grazes a tilted normal (`use_shadowing_function`) is switched off. A normal that
faces away from the viewer it tilts to the other side, or leaves it black (`flip_invalid_normals`), where we turn it until
it faces the viewer: here every normal does. Its green channel points along n x dp/du where the texture is mirrored, ours along
dp/dv: here they agree. (Its roughconductor masks separably, and so does normal_map.toml.)

    pip install mitsuba==3.9.1 numpy
    DRJIT_LIBLLVM_PATH=<libLLVM 19> python normal_map.py
"""

from pathlib import Path

import drjit as dr
import mitsuba as mi
import numpy as np

mi.set_variant("llvm_ad_rgb")

from pictures import write  # after the variant is set

HERE = Path(__file__).parent
MAP, QUAD = HERE / "normal_map.png", HERE / "normal_map.obj"
WIDTH, HEIGHT, SPP, SEEDS = 144, 64, 256, 16
EVENTS = 1
GOLD = ([0.143, 0.375, 1.442], [3.983, 2.386, 1.603])


def normals():
    row, column = np.indices((8, 8))
    x = 32768 + ((7 * column + 3 * row) % 11 - 5) * 2500
    y = 32768 + ((5 * column + 8 * row) % 13 - 6) * 2000
    return np.stack([x, y, np.full((8, 8), 60000)], axis=-1).astype(np.uint16)


def rgb(*values):
    return {"type": "rgb", "value": list(values)}


def scene():
    to = mi.ScalarTransform4f()
    mapped = lambda bsdf: {
        "type": "normalmap", "flip_invalid_normals": False, "use_shadowing_function": False,
        "normalmap": {"type": "bitmap", "filename": str(MAP), "raw": True}, "bsdf": bsdf,
    }
    square = lambda to_world, bsdf, **more: {
        "type": "obj", "filename": str(QUAD), "face_normals": True, "to_world": to_world, "bsdf": bsdf, **more,
    }
    gold = {
        "type": "roughconductor", "distribution": "ggx", "sample_visible": True, "alpha": 0.3,
        "eta": rgb(*GOLD[0]), "k": rgb(*GOLD[1]),
    }
    mirror = {"type": "conductor", "material": "none", "specular_reflectance": rgb(0.9, 0.9, 0.9)}
    return mi.load_dict({
        "type": "scene",
        "integrator": {"type": "path", "max_depth": EVENTS + 1},
        "sensor": {
            "type": "perspective", "fov": 24.0, "fov_axis": "y", "sampler": {"type": "independent"},
            "to_world": to.look_at([0.0, 3.6, 3.4], [0.0, 0.0, 0.0], [0, 1, 0]),
            "film": {"type": "hdrfilm", "width": WIDTH, "height": HEIGHT, "rfilter": {"type": "box"}},
        },
        "sky": {"type": "constant", "radiance": rgb(0.3, 0.35, 0.4)},
        "chalk": square(to.translate([-2, 0, 0]), mapped({"type": "diffuse", "reflectance": rgb(0.8, 0.6, 0.4)})),
        "gold": square(to.rotate([0, 1, 0], 90), mapped(gold)),
        "mirror": square(to.translate([2, 0, 0]).rotate([0, 1, 0], 200), mapped(mirror)),
        "lamp": square(
            to.translate([0.5, 1.2, -1.8]).rotate([1, 0, 0], 180).scale(0.3),
            {"type": "diffuse", "reflectance": rgb(0, 0, 0)},
            emitter={"type": "area", "radiance": rgb(20, 18, 16)},
        ),
    }, optimize=False)  # optimizing merges shapes of one material, and hides silhouettes


def main():
    dr.set_thread_count(1)
    mi.Bitmap(normals()).write(str(MAP))
    out = Path(__file__).with_suffix(".json")
    write(out, "normalmap", scene(), WIDTH, HEIGHT, SPP, SEEDS, EVENTS + 1)


if __name__ == "__main__":
    main()
