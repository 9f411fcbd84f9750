"""Mitsuba 3's pictures under a point, a spot and a distant light, and through a thin lens: references for tests/mitsuba.rs.

Writes lights.json and lens.json beside this file, whose fields pictures.py explains. The scenes are lights.toml and lens.toml
with the squares of normal_map.obj. Box filter, two scattering events, independent samples.

Mitsuba's `spot` takes the same two angles as ours and falls off linearly between them, too. `thinlens` has a radius where
we have a diameter.

    pip install mitsuba==3.9.1 numpy
    DRJIT_LIBLLVM_PATH=<libLLVM> python lights.py
"""

from pathlib import Path

import drjit as dr
import mitsuba as mi

mi.set_variant("llvm_ad_rgb")

from pictures import write  # after the variant is set

HERE = Path(__file__).parent
QUAD = HERE / "normal_map.obj"
WIDTH, HEIGHT, SPP, SEEDS = 128, 96, 256, 16
EVENTS = 2
GOLD = ([0.143, 0.375, 1.442], [3.983, 2.386, 1.603])


def rgb(*values):
    return {"type": "rgb", "value": list(values)}


def scene(sensor):
    to = mi.ScalarTransform4f()
    square = lambda to_world, bsdf: {
        "type": "obj", "filename": str(QUAD), "face_normals": True, "to_world": to_world,
        "bsdf": {"type": "twosided", "bsdf": bsdf},
    }
    gold = {
        "type": "roughconductor", "distribution": "ggx", "sample_visible": True, "alpha": 0.3,
        "eta": rgb(*GOLD[0]), "k": rgb(*GOLD[1]),
    }
    return mi.load_dict({
        "type": "scene",
        "integrator": {"type": "path", "max_depth": EVENTS + 1},
        "sensor": {
            "fov": 40.0, "fov_axis": "y", "sampler": {"type": "independent"},
            "to_world": to.look_at([0.5, 2.0, 5.5], [0.0, 0.6, 0.0], [0, 1, 0]),
            "film": {"type": "hdrfilm", "width": WIDTH, "height": HEIGHT, "rfilter": {"type": "box"}},
            **sensor,
        },
        "ground": square(to.scale(4.0), {"type": "diffuse", "reflectance": rgb(0.5, 0.45, 0.4)}),
        "chalk": square(
            to.translate([-1.2, 1.0, -0.5]).rotate([1, 0, 0], 70), {"type": "diffuse", "reflectance": rgb(0.8, 0.6, 0.4)},
        ),
        "gold": square(to.translate([1.2, 0.9, 0.6]).rotate([1, 0, 0], 55).scale(0.8), gold),
        "point": {"type": "point", "position": [0.3, 2.5, 2.0], "intensity": rgb(6, 8, 10)},
        "spot": {
            "type": "spot", "to_world": to.look_at([-3, 4, 3], [-0.8, 0.3, 0.5], [0, 1, 0]),
            "intensity": rgb(60, 45, 30), "cutoff_angle": 18.0, "beam_width": 9.0,
        },
        "distant": {"type": "directional", "direction": [-1.0, -1.5, -0.7], "irradiance": rgb(0.9, 1.0, 1.2)},
    }, optimize=False)  # optimizing merges shapes of one material, and hides silhouettes


def main():
    dr.set_thread_count(2)
    sensors = {
        "lights": {"type": "perspective"},
        "lens": {"type": "thinlens", "aperture_radius": 0.15, "focus_distance": 4.0},
    }
    for name, sensor in sensors.items():
        write(HERE / f"{name}.json", name, scene(sensor), WIDTH, HEIGHT, SPP, SEEDS, EVENTS + 1)


if __name__ == "__main__":
    main()
