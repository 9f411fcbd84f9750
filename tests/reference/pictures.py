"""What the reference pictures of Mitsuba 3 have in common: block means over seeds, and which blocks see edges.

    mean            mean over the seeds; flat, BLOCK x BLOCK blocks row by row from the top left, r g b interleaved
    variance        of one seed's block mean, estimated over the seeds (n - 1); that of `mean` is variance / seeds
    image_mean      the same two for the whole picture, r g b
    image_variance
    excluded        indices (row * blocks per row + column) of the blocks that see more than one shape, or an emitter's
"""

import json

import drjit as dr
import mitsuba as mi
import numpy as np

BLOCK = 8
SUBPIXELS = 8  # rays per pixel and axis in the search for silhouettes


def blocks(image):
    """Pixels of shape (height, width, ...) to (blocks, pixels of a block, ...)."""
    rows, columns = image.shape[0] // BLOCK, image.shape[1] // BLOCK
    tiles = image.reshape(rows, BLOCK, columns, BLOCK, -1).swapaxes(1, 2)
    return tiles.reshape(rows * columns, BLOCK * BLOCK, -1)


def seen_shapes(scene, width, height):
    """The shape behind each of SUBPIXELS^2 points per pixel, as (height, width, SUBPIXELS^2) numbers; 0 is none."""
    columns, rows = width * SUBPIXELS, height * SUBPIXELS
    i = dr.arange(mi.UInt32, columns * rows)
    film = (mi.Point2f(i % columns, i // columns) + 0.5) / mi.Point2f(columns, rows)
    ray, _ = scene.sensors()[0].sample_ray(0, 0.5, film, 0.5)
    shape = dr.reinterpret_array(mi.UInt32, scene.ray_intersect(ray).shape)
    grid = shape.numpy().reshape(height, SUBPIXELS, width, SUBPIXELS)
    return grid.swapaxes(1, 2).reshape(height, width, -1)


def excluded(scene, width, height):
    shapes = blocks(seen_shapes(scene, width, height)).reshape(width * height // BLOCK**2, -1)
    found = shapes.min(axis=1) != shapes.max(axis=1)
    for emitter in scene.emitters():
        lamp = dr.reinterpret_array(mi.UInt32, mi.ShapePtr(emitter.get_shape())).numpy()[0]
        if lamp:
            found |= (shapes == lamp).any(axis=1)
    return np.flatnonzero(found).tolist()


def seven_digits(values):
    return [float(f"{v:.7g}") for v in np.ravel(values)]


def write(path, title, scene, width, height, spp, seeds, max_depth, **more):
    """Renders the scene and writes the reference. `max_depth` is Mitsuba's, which counts the emitter too."""
    images = [mi.render(scene, spp=spp, seed=seed).numpy().astype(np.float64) for seed in range(seeds)]
    of_blocks = np.stack([blocks(image).mean(axis=1) for image in images])
    of_images = np.stack([image.mean(axis=(0, 1)) for image in images])
    reference = {
        "renderer": f"Mitsuba {mi.variant()}, {title}",
        "version": mi.__version__,
        "width": width,
        "height": height,
        "spp": spp,
        "max_depth": max_depth,
        "scattering_events": max_depth - 1,
        "seeds": seeds,
        "block": BLOCK,
        "image_mean": seven_digits(of_images.mean(axis=0)),
        "image_variance": seven_digits(of_images.var(axis=0, ddof=1)),
        "mean": seven_digits(of_blocks.mean(axis=0)),
        "variance": seven_digits(of_blocks.var(axis=0, ddof=1)),
        "excluded": excluded(scene, width, height),
    } | more
    lines = (f"  {json.dumps(key)}: {json.dumps(value)}" for key, value in reference.items())
    path.write_text("{\n" + ",\n".join(lines) + "\n}\n")
    error = np.sqrt(of_images.var(axis=0, ddof=1) / seeds) / of_images.mean(axis=0)
    print(f"{path.name}: image mean {reference['image_mean']} +- {error}, {len(reference['excluded'])} blocks excluded")
