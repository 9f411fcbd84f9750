"""Mitsuba 3's rough conductor (GGX, anisotropic, visible normals) and Fresnel equations at single points.

Writes roughconductor.json beside this file. Directions are local, z is the normal, x the tangent; all inputs
are exactly the single-precision numbers that Mitsuba was given, and its answers carry single precision:
no double-precision variant is published. `wo` is the viewer and `wi` the light (Mitsuba names them the
other way round); the second half of the configurations takes `wi` from Mitsuba's own sampling.

    configurations     alpha_x alpha_y eta[3] k[3] wo wi -> f_cos[3] pdf, and the factors d g1_o g1_i
    fresnel_conductor  cos eta k -> reflectance
    fresnel_dielectric cos eta (of the side below over that above; cos < 0 comes from below)
                       -> reflectance, cos_t (of the other sign, 0 in total reflection), eta_it (the index
                       behind over the index before, as the ray meets them)

Mitsuba's masking-shadowing is the separable g1_o * g1_i, not the height-correlated one; a kernel with G2
compares with f_cos * G2 / (g1_o * g1_i).

    pip install mitsuba==3.9.1 numpy
    python roughconductor.py
"""

import json
from pathlib import Path

import mitsuba as mi
import numpy as np

mi.set_variant("scalar_rgb")

CONFIGURATIONS, FRESNEL = 400, 50
SEED = 20

# (eta, k) at red, green and blue of gold, silver, copper, aluminium, iron, chromium, rounded; each
# configuration scales one of them by up to a third, so that a table of metals would not pass.
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


def metal(rng):
    eta, k = METALS[rng.integers(len(METALS))]
    return single(eta * rng.uniform(0.75, 1.33, 3)), single(k * rng.uniform(0.75, 1.33, 3))


def hemisphere(rng):
    z, phi = rng.uniform(), rng.uniform(0, 2 * np.pi)
    r = np.sqrt(1 - z * z)
    return single([r * np.cos(phi), r * np.sin(phi), z])


def configuration(rng, by_sampling):
    alpha_x, alpha_y = single(10 ** rng.uniform(-2, 0, 2))
    eta, k = metal(rng)
    bsdf = mi.load_dict({
        "type": "roughconductor", "distribution": "ggx", "sample_visible": True,
        "alpha_u": alpha_x, "alpha_v": alpha_y,
        "eta": {"type": "rgb", "value": eta}, "k": {"type": "rgb", "value": k},
    })
    hit, context = mi.SurfaceInteraction3f(), mi.BSDFContext()
    wo = hemisphere(rng)
    hit.wi = wo
    wi = hemisphere(rng)
    while by_sampling:
        sample, _ = bsdf.sample(context, hit, rng.uniform(), rng.uniform(size=2))
        wi = single(sample.wo)
        if wi[2] > 0 and sample.pdf > 0:
            break

    f_cos, pdf = bsdf.eval_pdf(context, hit, wi)
    ggx = mi.MicrofacetDistribution(mi.MicrofacetType.GGX, alpha_x, alpha_y)
    wm = mi.Normal3f(np.array(mi.Vector3f(wo) + mi.Vector3f(wi)))
    wm /= np.linalg.norm(wm)
    return {
        "alpha_x": alpha_x, "alpha_y": alpha_y, "eta": eta, "k": k, "wo": wo, "wi": wi,
        "f_cos": single(f_cos), "pdf": single(pdf),
        "d": single(ggx.eval(wm)), "g1_o": single(ggx.smith_g1(wo, wm)), "g1_i": single(ggx.smith_g1(wi, wm)),
    }


def conductor_point(rng):
    (eta, *_), (k, *_) = metal(rng)
    cos = single(rng.uniform())
    return {"cos": cos, "eta": eta, "k": k, "reflectance": single(mi.fresnel_conductor(cos, mi.Complex2f(eta, k)))}


def dielectric_point(rng):
    cos, eta = single(rng.uniform(-1, 1)), single(rng.uniform(0.4, 2.5))
    reflectance, cos_t, eta_it, _ = mi.fresnel(cos, eta)
    return {"cos": cos, "eta": eta, "reflectance": single(reflectance), "cos_t": single(cos_t), "eta_it": single(eta_it)}


def main():
    rng = np.random.default_rng(SEED)
    reference = {
        "renderer": "Mitsuba scalar_rgb, single precision",
        "version": mi.__version__,
        "configurations": [configuration(rng, 2 * i >= CONFIGURATIONS) for i in range(CONFIGURATIONS)],
        "fresnel_conductor": [conductor_point(rng) for _ in range(FRESNEL)],
        "fresnel_dielectric": [dielectric_point(rng) for _ in range(FRESNEL)],
    }
    out = Path(__file__).with_suffix(".json")
    text = json.dumps(reference).replace(': [{', ': [\n{').replace('}, {', '},\n{')
    out.write_text(text + "\n")
    print(f"{out.name}: {out.stat().st_size} bytes")


if __name__ == "__main__":
    main()
