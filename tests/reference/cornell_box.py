"""Mitsuba 3's picture of its Cornell box, the reference for scenes/cornell-box.toml.

Writes cornell_box.json beside this file: means over 8 x 8 pixel blocks, with the variance that says how
far another correct renderer may be from them. Box filter, 8 scattering events (Mitsuba's max_depth counts
the emitter too: 9), no Russian roulette, independent samples.

    mean            mean over the seeds; flat, 32 x 32 blocks row by row from the top left, r g b interleaved
    variance        of one seed's block mean, estimated over the seeds (n - 1); that of `mean` is variance / seeds
    image_mean      the same two for the whole picture, r g b
    image_variance
    excluded        indices (row * 32 + column) of the blocks that see the lamp, or more than one shape
    lamp_back       the blocks that the back of the lamp lights, if it reflects

Mitsuba's diffuse surfaces are black from behind, which matters for the lamp alone: 1 cm under the ceiling,
a lamp that is white on both sides makes the ceiling along its front edge 1 to 2 % brighter (`lamp_back`,
measured), and the whole picture by 2 parts in 10,000 in red, less in green and blue.

    pip install mitsuba==3.9.1 numpy
    DRJIT_LIBLLVM_PATH=<libLLVM 19> python cornell_box.py [threads]
"""

import json
import sys
from pathlib import Path

import drjit as dr
import mitsuba as mi
import numpy as np

mi.set_variant("llvm_ad_rgb")

SIZE, BLOCK, SPP, SEEDS = 256, 8, 64, 16
MAX_DEPTH = 9  # 8 scattering events
NO_ROULETTE = 1000  # the depth at which roulette would begin
LAMP_BACK = range(3 * 32 + 13, 3 * 32 + 19)  # found by comparing with a two-sided lamp
SUBPIXELS = 8  # rays per pixel and axis in the search for silhouettes


def scene():
    box = mi.cornell_box()
    box["integrator"].update(max_depth=MAX_DEPTH, rr_depth=NO_ROULETTE)
    box["sensor"]["film"].update(width=SIZE, height=SIZE, rfilter={"type": "box"})
    return mi.load_dict(box, optimize=False)  # optimizing merges shapes of one material, and hides silhouettes


def blocks(image):
    """Pixels of shape (SIZE, SIZE, ...) to (blocks, pixels of a block, ...)."""
    n = SIZE // BLOCK
    tiles = image.reshape(n, BLOCK, n, BLOCK, -1).swapaxes(1, 2)
    return tiles.reshape(n * n, BLOCK * BLOCK, -1)


def seen_shapes(scene):
    """The shape behind each of SUBPIXELS^2 points per pixel, as (SIZE, SIZE, SUBPIXELS^2) numbers; 0 is none."""
    n = SIZE * SUBPIXELS
    i = dr.arange(mi.UInt32, n * n)
    film = (mi.Point2f(i % n, i // n) + 0.5) / n
    ray, _ = scene.sensors()[0].sample_ray(0, 0.5, film, 0.5)
    shape = dr.reinterpret_array(mi.UInt32, scene.ray_intersect(ray).shape)
    grid = shape.numpy().reshape(SIZE, SUBPIXELS, SIZE, SUBPIXELS)
    return grid.swapaxes(1, 2).reshape(SIZE, SIZE, -1)


def excluded(scene):
    lamp = dr.reinterpret_array(mi.UInt32, mi.ShapePtr(scene.emitters()[0].get_shape())).numpy()[0]
    shapes = blocks(seen_shapes(scene)).reshape((SIZE // BLOCK) ** 2, -1)
    mixed = shapes.min(axis=1) != shapes.max(axis=1)
    return np.flatnonzero(mixed | (shapes == lamp).any(axis=1)).tolist()


def seven_digits(values):
    return [float(f"{v:.7g}") for v in np.ravel(values)]


def main():
    dr.set_thread_count(int(sys.argv[1]) if len(sys.argv) > 1 else 1)
    box = scene()
    images = [mi.render(box, spp=SPP, seed=seed).numpy().astype(np.float64) for seed in range(SEEDS)]
    of_blocks = np.stack([blocks(image).mean(axis=1) for image in images])
    of_images = np.stack([image.mean(axis=(0, 1)) for image in images])

    reference = {
        "renderer": "Mitsuba llvm_ad_rgb, cornell_box()",
        "version": mi.__version__,
        "width": SIZE,
        "height": SIZE,
        "spp": SPP,
        "max_depth": MAX_DEPTH,
        "scattering_events": MAX_DEPTH - 1,
        "seeds": SEEDS,
        "block": BLOCK,
        "image_mean": seven_digits(of_images.mean(axis=0)),
        "image_variance": seven_digits(of_images.var(axis=0, ddof=1)),
        "mean": seven_digits(of_blocks.mean(axis=0)),
        "variance": seven_digits(of_blocks.var(axis=0, ddof=1)),
        "excluded": excluded(box),
        "lamp_back": list(LAMP_BACK),
    }
    out = Path(__file__).with_suffix(".json")
    lines = (f"  {json.dumps(key)}: {json.dumps(value)}" for key, value in reference.items())
    out.write_text("{\n" + ",\n".join(lines) + "\n}\n")
    print(f"{out.name}: image mean {reference['image_mean']}, {len(reference['excluded'])} blocks excluded")


if __name__ == "__main__":
    main()
