"""Mitsuba 3's BSDFs and Fresnel equations at single points.

Writes bsdfs.json beside this file, one material per line. Directions are local, z is the normal, x the tangent; `wo` is
the viewer and `wi` the light (Mitsuba names them the other way round); values are those of radiance. All inputs are
exactly the single-precision numbers that Mitsuba was given, and its answers carry single precision: no double-precision
variant is published.

    model                                           parameters                  rows
    diffuse                                         reflectance[3]              wo[3] wi[3] f_cos[3] pdf
    roughconductor-ggx, roughconductor-beckmann     alpha_x alpha_y eta[3] k[3] the same
    roughdielectric-ggx, roughdielectric-beckmann   alpha_x alpha_y eta         the same, from both sides to both sides
    dielectric                                      eta                         the same of a discrete event: its
                                                                                probability, and that times its weight
    fresnel_conductor                               eta k                       cos reflectance
    fresnel_dielectric                              eta, below over above       cos (< 0 from below) reflectance

Half of the rows of a material take wi from Mitsuba's own sampling; of the other half every other pair is grazing on one
side or both. Rows that Mitsuba's sampling cannot give (it failed) are drawn again.

    pip install mitsuba==3.9.1 numpy
    python bsdfs.py                                      bsdfs.json, which is committed
    python bsdfs.py --count 100000 --rows 20 --out FILE  a large one: GONIO_MITSUBA=FILE gonio validate --only mitsuba
"""

import argparse
import json
from pathlib import Path

import mitsuba as mi
import numpy as np

mi.set_variant("scalar_rgb")

SEED = 20
LEAST_COS = 1e-4

# (eta, k) at red, green and blue of gold, silver, copper, aluminium, iron, chromium, rounded; each
# material scales one of them by up to a third, so that a table of metals would not pass.
METALS = [
    ((0.143, 0.375, 1.442), (3.983, 2.386, 1.603)),
    ((0.155, 0.117, 0.138), (4.828, 3.122, 2.147)),
    ((0.200, 0.924, 1.102), (3.912, 2.452, 2.142)),
    ((1.657, 0.880, 0.521), (9.224, 6.270, 4.837)),
    ((2.911, 2.950, 2.585), (3.089, 2.932, 2.767)),
    ((3.180, 3.180, 2.010), (3.310, 3.320, 2.870)),
]


def single(x):
    """Rounds to single precision, kept as Python floats that JSON writes exactly."""
    return np.float32(x).tolist()


def shortest(x):
    """The shortest text that reads as this single-precision number."""
    return np.format_float_scientific(np.float32(x), unique=True, trim="-", exp_digits=1)


def direction(rng, grazing, both_sides):
    z = LEAST_COS ** rng.uniform() if grazing else rng.uniform(1e-3, 1)
    phi, r = rng.uniform(0, 2 * np.pi), np.sqrt(1 - z * z)
    side = rng.choice([-1, 1]) if both_sides else 1
    return single([r * np.cos(phi), r * np.sin(phi), side * z])


def metal(rng):
    eta, k = METALS[rng.integers(len(METALS))]
    return single(eta * rng.uniform(0.75, 1.33, 3)), single(k * rng.uniform(0.75, 1.33, 3))


def index(rng):
    """Up to 2.5 either way, but not so near to 1 that there is hardly an interface."""
    eta = single(1 + 10 ** rng.uniform(-2, np.log10(1.5)))
    return eta if rng.uniform() < 0.5 else single(1 / eta)


def widths(rng):
    return single(10 ** rng.uniform(-3, 0, 2))


def rgb(values):
    return {"type": "rgb", "value": values}


def diffuse(rng):
    reflectance = single(rng.uniform(size=3))
    return reflectance, {"type": "diffuse", "reflectance": rgb(reflectance)}


def roughconductor(distribution):
    def material(rng):
        (alpha_x, alpha_y), (eta, k) = widths(rng), metal(rng)
        return [alpha_x, alpha_y, *eta, *k], {
            "type": "roughconductor", "distribution": distribution, "sample_visible": True,
            "alpha_u": alpha_x, "alpha_v": alpha_y, "eta": rgb(eta), "k": rgb(k),
        }
    return material


def roughdielectric(distribution):
    def material(rng):
        (alpha_x, alpha_y), eta = widths(rng), index(rng)
        return [alpha_x, alpha_y, eta], {
            "type": "roughdielectric", "distribution": distribution, "sample_visible": True,
            "alpha_u": alpha_x, "alpha_v": alpha_y, "int_ior": eta, "ext_ior": 1.0,
        }
    return material


def dielectric(rng):
    eta = index(rng)
    return [eta], {"type": "dielectric", "int_ior": eta, "ext_ior": 1.0}


MODELS = {
    "diffuse": diffuse,
    "roughconductor-ggx": roughconductor("ggx"),
    "roughconductor-beckmann": roughconductor("beckmann"),
    "roughdielectric-ggx": roughdielectric("ggx"),
    "roughdielectric-beckmann": roughdielectric("beckmann"),
    "dielectric": dielectric,
}


def row(rng, bsdf, model, by_sampling, grazing):
    context, hit = mi.BSDFContext(), mi.SurfaceInteraction3f()
    both_sides = "dielectric" in model
    while True:
        wo = direction(rng, grazing and rng.uniform() < 0.7, both_sides)
        hit.wi = wo
        if by_sampling or model == "dielectric":
            sample, weight = bsdf.sample(context, hit, rng.uniform(), rng.uniform(size=2))
            wi = single(sample.wo)
            if wi[2] == 0 or not sample.pdf > 0:
                continue
            if model == "dielectric":
                return wo, wi, [w * sample.pdf for w in weight], [sample.pdf]
        else:
            wi = direction(rng, grazing and rng.uniform() < 0.7, both_sides)
        f_cos, pdf = bsdf.eval_pdf(context, hit, wi)
        return wo, wi, f_cos, [pdf]


def bsdf_lines(rng, model, count, rows):
    for _ in range(count // rows):
        parameters, description = MODELS[model](rng)
        bsdf = mi.load_dict(description)
        yield parameters, [row(rng, bsdf, model, i % 2 == 0, i % 4 == 1) for i in range(rows)]


def fresnel_conductor(rng, count):
    for _ in range(count):
        (eta, *_), (k, *_) = metal(rng)
        cos = single(rng.uniform())
        yield [eta, k], [([cos], [mi.fresnel_conductor(cos, mi.Complex2f(eta, k))])]


def fresnel_dielectric(rng, count):
    for _ in range(count):
        cos, eta = single(rng.uniform(-1, 1)), single(rng.uniform(0.4, 2.5))
        yield [eta], [([cos], [mi.fresnel(cos, eta)[0]])]


def line(model, parameters, rows):
    numbers = lambda values: "[" + ", ".join(map(shortest, values)) + "]"
    flat = [x for one in rows for part in one for x in part]
    return f'{{"model": "{model}", "parameters": {numbers(parameters)}, "rows": {numbers(flat)}}}'


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=400, help="rows per model")
    parser.add_argument("--rows", type=int, default=4, help="rows per material: a multiple of 4")
    parser.add_argument("--out", type=Path, default=Path(__file__).with_suffix(".json"))
    args = parser.parse_args()

    rng = np.random.default_rng(SEED)
    with args.out.open("w") as out:
        header = {"renderer": "Mitsuba scalar_rgb, single precision", "version": mi.__version__}
        out.write(json.dumps(header)[:-1] + ', "materials": [\n')
        sets = {model: bsdf_lines(rng, model, args.count, args.rows) for model in MODELS}
        sets["fresnel_conductor"] = fresnel_conductor(rng, args.count)
        sets["fresnel_dielectric"] = fresnel_dielectric(rng, args.count)
        lines = (line(model, *material) for model, materials in sets.items() for material in materials)
        out.write(next(lines))
        out.writelines(",\n" + text for text in lines)
        out.write("\n]}\n")
    print(f"{args.out.name}: {args.out.stat().st_size} bytes")


if __name__ == "__main__":
    main()
