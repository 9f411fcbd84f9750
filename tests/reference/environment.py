"""Mitsuba 3's pictures of four objects under environment maps, the references for tests/environment.rs.

Writes environment_NAME.json beside this file, whose fields pictures.py explains, for a map of a formula and for each
.hdr file named: a grey ground, and above it a diffuse, a rough gold and a mirror sphere of flat triangles. Box filter,
no Russian roulette, independent samples. The map is turned by 37 degrees about +y and multiplied by 0.7.

Mitsuba's envmap puts the centres of the first and last row of texels on the poles; a row of texels of a panorama covers
its share of the angle from pole to pole, so that its centre lies half a row inside. `centred` makes the picture of 2h + 1
rows with which Mitsuba shows just that.

    pip install mitsuba==3.9.1 numpy
    DRJIT_LIBLLVM_PATH=<libLLVM 19> python environment.py [brown_photostudio_02_1k.hdr noon_grass_1k.hdr]
"""

import sys
from pathlib import Path

import drjit as dr
import mitsuba as mi
import numpy as np

mi.set_variant("llvm_ad_rgb")

from pictures import write  # after the variant is set

HERE = Path(__file__).parent
SPHERE = str(HERE / "../../scenes/sphere.obj")
WIDTH, HEIGHT, SPP, SEEDS = 128, 96, 256, 16
NO_ROULETTE = 1000  # the depth at which roulette would begin
# Scattering events: where the sun is small, what a mirror throws on the ground is noise without end.
EVENTS = {"formula": 3, "brown_photostudio_02_1k": 3, "noon_grass_1k": 1}
ROTATION, INTENSITY = 37.0, 0.7
GOLD = ([0.143, 0.375, 1.442], [3.983, 2.386, 1.603])


def formula():
    """24 x 12 texels in sixteenths, with a small sun that is no texel of the seam."""
    row, column, channel = np.indices((12, 24, 3))
    picture = (column * 7 + row * 13 + channel * 5) % 17 / 16
    picture[3, 17] = [60, 50, 40]
    return picture.astype(np.float32)


def centred(picture):
    """The picture whose envmap is that of `picture` with the centres of its rows half a row inside."""
    rows = np.empty((2 * len(picture) + 1, *picture.shape[1:]), np.float32)
    rows[1::2], rows[0], rows[-1] = picture, picture[0], picture[-1]
    rows[2:-1:2] = 0.5 * (picture[:-1] + picture[1:])
    return rows


def rgb(*values):
    return {"type": "rgb", "value": list(values)}


def scene(picture, events):
    to = mi.ScalarTransform4f()
    diffuse = lambda *color: {"type": "diffuse", "reflectance": rgb(*color)}
    two_sided = lambda bsdf: {"type": "twosided", "bsdf": bsdf}
    sphere = lambda x, bsdf: {
        "type": "obj", "filename": SPHERE, "face_normals": True, "bsdf": bsdf,
        "to_world": to.translate([x, 0.7, 0.0]).scale(0.65),
    }
    gold = {
        "type": "roughconductor", "distribution": "ggx", "sample_visible": True, "alpha": 0.2,
        "eta": rgb(*GOLD[0]), "k": rgb(*GOLD[1]),
    }
    return mi.load_dict({
        "type": "scene",
        "integrator": {"type": "path", "max_depth": events + 1, "rr_depth": NO_ROULETTE},
        "sensor": {
            "type": "perspective", "fov": 40.0, "fov_axis": "y", "sampler": {"type": "independent"},
            "to_world": to.look_at([0.5, 2.0, 5.5], [0.0, 0.6, 0.0], [0, 1, 0]),
            "film": {"type": "hdrfilm", "width": WIDTH, "height": HEIGHT, "rfilter": {"type": "box"}},
        },
        "sky": {
            "type": "envmap", "bitmap": mi.Bitmap(centred(picture)), "scale": INTENSITY,
            "to_world": to.rotate([0, 1, 0], ROTATION),
        },
        "ground": {
            "type": "rectangle", "bsdf": two_sided(diffuse(0.5, 0.45, 0.4)),
            "to_world": to.rotate([1, 0, 0], -90).scale(4),
        },
        "chalk": sphere(-1.5, diffuse(0.8, 0.6, 0.4)),
        "gold": sphere(0.0, gold),
        "mirror": sphere(1.5, {"type": "conductor", "material": "none", "specular_reflectance": rgb(0.9, 0.9, 0.9)}),
    }, optimize=False)  # optimizing merges shapes of one material, and hides silhouettes


def main():
    dr.set_thread_count(1)
    maps = {"formula": formula()}
    for name in map(Path, sys.argv[1:]):
        maps[name.stem] = np.array(mi.Bitmap(str(name)).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, False))
    for name, picture in maps.items():
        out = HERE / f"environment_{name}.json"
        events = EVENTS.get(name, 1)
        write(out, f"under {name}", scene(picture, events), WIDTH, HEIGHT, SPP, SEEDS, events + 1)


if __name__ == "__main__":
    main()
