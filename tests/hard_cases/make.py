#!/usr/bin/env python3
"""Writes the hard cases. Every expected number is a textbook formula evaluated by mpmath with 60 digits: nothing here is
taken from the kernel. Usage: python3 tests/hard_cases/make.py (needs mpmath)."""
import json
import os
from mpmath import mp, mpf, sqrt, exp, erf, pi, acos, log, floor

mp.dps = 60
HERE = os.path.dirname(os.path.abspath(__file__))
F32_MIN, DENORMAL = "0x1p-126", "0x1p-149"


def num(x):
    """A number as the kernel reads it: exactly the f64 that is written."""
    if isinstance(x, str):
        special = {"nan": mp.nan, "inf": mp.inf, "-inf": -mp.inf, "-0.0": mpf(0)}
        if x in special:
            return special[x]
        mantissa, exponent = x.replace("0x", "").split("p")
        return mpf(int(mantissa, 16)) * mpf(2) ** int(exponent)
    return mpf(x)


def vec(w):
    return [num(x) for x in w]


def unit(w):
    length = sqrt(sum(x * x for x in w))
    return [x / length for x in w]


def at(sin, axis=0, sign=1):
    """A direction in the plane of an axis whose cosine is not formed by subtraction in the file."""
    cos = float(sqrt(1 - mpf(sin) ** 2))
    w = [0.0, 0.0, cos]
    w[axis] = sign * sin
    return w


def schlick(f0, c):
    return f0 + (1 - f0) * (1 - c) ** 5


def dielectric(eta, c):
    s2 = (1 - c * c) / (eta * eta)
    if s2 >= 1:
        return mpf(1)
    t = sqrt(1 - s2)
    return (((eta * c - t) / (eta * c + t)) ** 2 + ((c - eta * t) / (c + eta * t)) ** 2) / 2


def conductor(eta, k, c):
    n, s2 = mp.mpc(eta, -k), 1 - c * c
    t = sqrt(1 - s2 / (n * n))
    parallel, across = (n * c - t) / (n * c + t), (c - n * t) / (c + n * t)
    return (abs(parallel) ** 2 + abs(across) ** 2) / 2


def d_ggx(m, ax, ay):
    return 1 / (pi * ax * ay * ((m[0] / ax) ** 2 + (m[1] / ay) ** 2 + m[2] ** 2) ** 2)


def lambda_ggx(w, ax, ay):
    return (sqrt(1 + ((ax * w[0]) ** 2 + (ay * w[1]) ** 2) / w[2] ** 2) - 1) / 2


def d_beckmann(m, ax, ay):
    return exp(-((m[0] / ax) ** 2 + (m[1] / ay) ** 2) / m[2] ** 2) / (pi * ax * ay * m[2] ** 4)


def lambda_beckmann(w, ax, ay):
    tangent = sqrt((ax * w[0]) ** 2 + (ay * w[1]) ** 2)
    if tangent == 0:
        return mpf(0)
    a = abs(w[2]) / tangent
    return (erf(a) - 1) / 2 + exp(-a * a) / (2 * a * sqrt(pi))


def reflector(wo, wi, ax, ay, fresnel, distribution="ggx", masking="correlated"):
    """f cos_i of Cook and Torrance with Smith's masking."""
    wo, wi, ax, ay = unit(vec(wo)), unit(vec(wi)), mpf(ax), mpf(ay)
    m = unit([a + b for a, b in zip(wo, wi)])
    c = sum(a * b for a, b in zip(wo, m))
    d, lam = (d_ggx, lambda_ggx) if distribution == "ggx" else (d_beckmann, lambda_beckmann)
    o, i = lam(wo, ax, ay), lam(wi, ax, ay)
    g = 1 / (1 + o + i) if masking == "correlated" else 1 / ((1 + o) * (1 + i))
    return fresnel(c) * d(m, ax, ay) * g / (4 * wo[2])


def phong(wo, wi, kd, ks, exponent, norm):
    wo, wi = unit(vec(wo)), unit(vec(wi))
    # Near the peak: cos = 1 - |wo - mirrored|^2/2 for unit vectors.
    cos = 1 - ((wo[0] + wi[0]) ** 2 + (wo[1] + wi[1]) ** 2 + (wo[2] - wi[2]) ** 2) / 2
    n = exponent + (2 if norm == "lafortune" else 1)
    return (kd / pi + ks * n / (2 * pi) * cos ** exponent) * wi[2]


def eon(wo, wi, rho, r):
    """Portsmouth, Kutz & Hill 2025, with the exact directional albedo."""
    wo, wi, rho, r = unit(vec(wo)), unit(vec(wi)), mpf(rho), mpf(r)
    c1, c2 = mpf(1) / 2 - 2 / (3 * pi), mpf(2) / 3 - 28 / (15 * pi)
    a = 1 / (1 + c1 * r)
    s = wo[0] * wi[0] + wo[1] * wi[1]
    t = max(wo[2], wi[2]) if s > 0 else mpf(1)

    def lost(mu):
        sin = sqrt(1 - mu * mu)
        g = sin * (acos(mu) - sin * mu) + mpf(2) / 3 * (sin / mu * (1 - sin ** 3) - sin)
        return 1 - a * (1 + r * g / pi)

    average = a * (1 + c2 * r)
    single = rho / pi * a * (1 + r * s / t)
    if r == 0:
        return single * wi[2]
    multiple = rho ** 2 * average / (1 - rho * (1 - average))
    return (single + multiple / pi * lost(wo[2]) * lost(wi[2]) / (1 - average)) * wi[2]


UP = [0, 0, 1]
SLANT, MIRRORED = [0.6, 0, 0.8], [-0.6, 0, 0.8]
FILES = {}


def case(file, name, origin, material, expect, how, **inputs):
    if any(known["name"] == name for known in FILES.get(file, [])):
        return  # the same by another way, as a tangent that is the normal
    FILES.setdefault(file, []).append(
        {"name": name, "origin": origin, "material": material, **inputs, "expect": expect, "how": how})


def grey(x):
    return [x, x, x]


def metal(f0=1.0, **width):
    return {"type": "conductor", "f0": grey(f0), **(width or {"alpha": 0.3})}


MODELS = {
    "diffuse": {"type": "diffuse", "base_color": grey(0.8)},
    "eon": {"type": "eon", "base_color": grey(0.8), "roughness": 1.0},
    "eon fitted": {"type": "eon", "base_color": grey(0.8), "roughness": 1.0, "albedo": "fitted"},
    "mirror": {"type": "mirror", "reflectance": grey(0.9)},
    "phong": {"type": "phong", "diffuse": grey(0.3), "glossy": grey(0.6), "exponent": 30.0},
    "ggx": metal(0.9, alpha=0.1),
    "ggx separable": {**metal(0.9, alpha=0.1), "masking": "separable"},
    "ggx anisotropic": metal(0.9, alpha_x=0.01, alpha_y=0.5),
    "beckmann": {**metal(0.9, alpha=0.1), "distribution": "beckmann"},
    "gold": {"type": "conductor", "eta": [0.143, 0.375, 1.442], "k": [3.983, 2.386, 1.603], "alpha": 0.1},
    "glass": {"type": "dielectric", "ior": 1.5},
    "ground glass": {"type": "dielectric", "ior": 1.5, "alpha": 0.1},
}
SINGLE_SIDED = [m for m in MODELS if "glass" not in m]


def value(x, tolerance=None, f64=None):
    """A value with its relative tolerance in f32 and, if another, in f64."""
    x = float(x)
    expect = {"f_cos": x}
    if tolerance:
        expect["tolerance"] = tolerance
    if f64:
        expect["tolerance_f64"] = f64
    return expect


def grazing():
    file = "grazing"
    origin = "bevy#22833, bevy#16534: grazing views gave negative albedos and NaN"
    for name in MODELS:
        for cos in [1e-7, 1e-19, 1e-30, 1e-38, DENORMAL]:
            for wo, wi in [([1, 0, cos], UP), (UP, [1, 0, cos]), ([1, 0, cos], [-1, 0, cos]), ([1, 0, cos], [0, 1, cos]),
                           ([1, 0, cos], [1, 0, cos])]:
                case(file, f"{name}: cosines of {cos}, wo {wo}, wi {wi}", origin, MODELS[name], {"finite": True},
                     "law: inside the domain no value is NaN, infinite or negative", wo=wo, wi=wi)
    for name in SINGLE_SIDED:
        for cos in [0, "-0.0", -1e-38, -0.5]:
            z = cos if cos != -0.5 else cos
            x = 1 if cos != -0.5 else float(sqrt(mpf(3)) / 2)
            for wo, wi in [([x, 0, z], UP), (UP, [x, 0, z])]:
                case(file, f"{name}: in or below the surface, wo {wo}, wi {wi}", origin, MODELS[name], {"zero": True},
                     "law: an opaque surface neither shows nor receives light from below", wo=wo, wi=wi)
    for cos in [1e-3, 1e-7, 1e-19, 1e-30, 1e-38]:
        wo, wi = [1, 0, cos], [-1, 0, cos]
        alpha = 0.3
        case(file, f"ggx mirrored at a cosine of {cos}", origin, metal(1.0, alpha=alpha),
             value(1 / (4 * pi * mpf(alpha) ** 2 * sqrt(mpf(cos) ** 2 + mpf(alpha) ** 2)), 2e-5, 1e-5),
             "closed form: h is the normal, D = 1/(pi a^2), F = 1, so f cos_i = 1/(4 pi a^2 sqrt(c^2 + a^2 sin^2))",
             wo=wo, wi=wi)
        case(file, f"diffuse at a cosine of {cos}", origin, MODELS["diffuse"], value(mpf(0.8) / pi * mpf(cos), 1e-6, 1e-6),
             "closed form: rho cos_i/pi", wo=UP, wi=wi)
    for cos in [1e-3, 1e-5]:
        case(file, f"eon from the normal to a cosine of {cos}", origin, MODELS["eon"],
             value(eon(UP, [1, 0, cos], 0.8, 1), 1e-4, 1e-5), "the paper's formula, mpmath, 60 digits", wo=UP, wi=[1, 0, cos])


def narrow():
    file = "narrow"
    small = "pbrt-v3#214: a highlight of alpha 1e-6 vanished; barney#56 (filament's notes), armory#2880: alpha^4 underflows"
    for alpha in [1e-8, 1e-6, 1e-4, 0.01, 0.3, 1.0]:
        a = mpf(alpha)
        for distribution in ["ggx", "beckmann"]:
            material = {**metal(0.5, alpha=alpha), "distribution": distribution}
            f = lambda c: schlick(mpf(0.5), c)
            case(file, f"{distribution}: the peak of alpha {alpha} along the normal", small, material,
                 value(mpf(0.5) / (4 * pi * a * a), 1e-5), "closed form: f0/(4 pi alpha^2)", wo=UP, wi=UP)
            case(file, f"{distribution}: the peak of alpha {alpha} in the mirror direction", small, material,
                 value(reflector(SLANT, MIRRORED, a, a, f, distribution), 1e-5),
                 "Cook and Torrance with Smith's height-correlated masking, mpmath, 60 digits", wo=SLANT, wi=MIRRORED)
            case(file, f"{distribution}: far from the peak of alpha {alpha}", small, material, {"finite": True},
                 "law: D may underflow, but not to NaN", wo=SLANT, wi=[0.6, 0, 0.8])
            if alpha <= 0.01:
                case(file, f"{distribution} of alpha {alpha} is nearly a mirror", small, material,
                     {"equals_mirror": max(100 * alpha, 1e-6), "weight": float(schlick(mpf(0.5), mpf(0.8)))},
                     "limit: as alpha -> 0 samples go where a mirror sends them and weigh F", wo=SLANT)
    for alpha, tilt in [(1e-3, 1e-4), (1e-3, 1e-3), (0.01, 0.003)]:
        wi = at(tilt)
        f = lambda c: mpf(1)
        for distribution in ["ggx", "beckmann"]:
            case(file, f"{distribution}: {tilt} off the normal, alpha {alpha}", "filament: 1 - cos^2 cancels near the normal; "
                 "barney#56", {**metal(1.0, alpha=alpha), "distribution": distribution},
                 value(reflector(UP, wi, alpha, alpha, f, distribution), 1e-4, 1e-6),
                 "Cook and Torrance, mpmath, 60 digits", wo=UP, wi=wi)
    for x, y in [(1e-3, 1.0), (1.0, 1e-3), (1e-8, 1e-5)]:
        for distribution in ["ggx", "beckmann"]:
            case(file, f"{distribution}: widths {x} and {y}", "pbrt-v3#273: mixed zero and non-zero widths divided by zero",
                 {**metal(1.0, alpha_x=x, alpha_y=y), "distribution": distribution},
                 value(reflector(SLANT, MIRRORED, x, y, lambda c: mpf(1), distribution), 1e-5),
                 "Cook and Torrance, mpmath, 60 digits", wo=SLANT, wi=MIRRORED)
    for widths in [(0, 0.5), (0.5, 0), (0, 0), (-0.1, 0.5), (1.5, 0.5), ("nan", 0.5), (0.5, "inf"), (DENORMAL, 0.5), (1e-12, 0.5)]:
        for distribution in ["ggx", "beckmann"]:
            material = {**metal(0.9, alpha_x=widths[0], alpha_y=widths[1]), "distribution": distribution}
            case(file, f"{distribution}: widths {widths} lie outside of the domain", "pbrt-v3#273", material,
                 {"zero": True, "sample_fails": True}, "law: outside of the domain everything is exactly zero",
                 wo=SLANT, wi=MIRRORED)
    for widths in [(0, 0.5), (0.5, 0), (1.5, 0.5)]:
        case(file, f"a material file with widths {widths}", "pbrt-v3#273", metal(0.9, alpha_x=widths[0], alpha_y=widths[1]),
             {"refused": "alpha"}, "rule: what the model cannot be is refused with its line")
    case(file, "beckmann underflows to nothing", "pbrt-v3#273; Beckmann's exp(-tan^2/alpha^2)", {**metal(1.0, alpha=0.01),
         "distribution": "beckmann"}, {"finite": True, "f_cos_below": 1e-30}, "closed form: exp(-7.7e4) is 0 in f64 too",
         wo=UP, wi=[0.8, 0, 0.6])
    for exponent in [0.0, 1.0, 1e3, 1e7]:
        for norm in ["lecture", "lafortune"]:
            material = {"type": "phong", "diffuse": grey(0.0), "glossy": grey(1.0), "exponent": exponent, "normalization": norm}
            case(file, f"phong {norm}: the peak of exponent {exponent:g}", "pow(cos, n) of a cosine that is rounded: the peak of a large exponent is lost",
                 material, value(phong(SLANT, MIRRORED, 0, 1, mpf(exponent), norm), 1e-5), "closed form: n/(2 pi) cos_i",
                 wo=SLANT, wi=MIRRORED)
            case(file, f"phong {norm}: far from the peak of exponent {exponent:g}", "pow underflows", material, {"finite": True},
                 "law: finite and not negative", wo=SLANT, wi=[0.6, 0, 0.8])
    case(file, "phong: exponent 1e8 lies outside of the domain", "pow overflows", {"type": "phong", "diffuse": grey(0.0), "glossy":
         grey(1.0), "exponent": 1e8}, {"zero": True, "sample_fails": True}, "law: outside of the domain everything is zero",
         wo=SLANT, wi=MIRRORED)


def alignment():
    file = "alignment"
    for name in MODELS:
        for wo in [UP, SLANT, [0, 0.8, 0.6], [0.6, 0.48, 0.64]]:
            back = [-x for x in wo]
            case(file, f"{name}: wi = wo = {wo}", "mitsuba3#957: NaN when both directions are equal", MODELS[name],
                 {"finite": True}, "law: finite and not negative", wo=wo, wi=wo)
            expect = {"finite": True} if "glass" in name else {"zero": True}
            case(file, f"{name}: wi = -wo = {back}", "mitsuba3#957: the half vector of opposite directions is zero", MODELS[name],
                 expect, "law: finite; black through an opaque surface", wo=wo, wi=back)
        case(file, f"{name}: opposite in the surface", "mitsuba3#957", MODELS[name], {"finite": True},
             "law: finite and not negative", wo=[1, 0, 0], wi=[-1, 0, 0])
    for name, model in [("ggx", metal(1.0, alpha=0.5)), ("beckmann", {**metal(1.0, alpha=0.5), "distribution": "beckmann"})]:
        case(file, f"{name}: back to where it came from", "mitsuba3#957", model,
             value(reflector(SLANT, SLANT, 0.5, 0.5, lambda c: mpf(1), name), 1e-5), "Cook and Torrance, mpmath, 60 digits",
             wo=SLANT, wi=SLANT)


def fresnel():
    file = "fresnel"
    origin = "pbrt-v4#283, pbrt-v4#222: NaN at reflectance 1 and at zeros"
    for eta in [1.0, 1.0000001, 0.9999999, 1.01, 1.5, 1 / 1.5, 2.4, 0.01, 100.0]:
        for cos, wo in [(1, UP), (0.8, SLANT), (None, [1, 0, 1e-6])]:
            c = unit(vec(wo))[2]
            e = mpf(eta)
            r = dielectric(e, c)
            # Between 1 and the next f32 the share rises from 0 to 0.99: in f32 the index itself is off by up to 6e-8.
            steep = cos is None and eta == 1.0000001
            case(file, f"glass of index {eta}: reflected share at {wo}", origin, {"type": "dielectric", "ior": eta},
                 {"reflectance": float(r) if r > 1e-50 else 0.0, "absolute": 1e-3 if steep else 2e-6, "absolute_f64": 1e-9 if cos else 2e-6},
                 "Fresnel's equations (Born & Wolf 1.5), mpmath, 60 digits", wo=wo)
    sin_c = float(1 / mpf(1.5))
    for sin, total in [(sin_c + 1e-3, True), (sin_c + 1e-6, True), (0.9, True), (sin_c - 1e-3, False)]:
        wo = at(sin)
        wo[2] = -wo[2]
        r = mpf(1) if total else dielectric(1 / mpf(1.5), abs(unit(vec(wo))[2]))
        case(file, f"from within glass at sin {sin:.7f}", "total reflection: NaN of the root of a negative number", MODELS["glass"],
             {"reflectance": float(r), "absolute": 1e-4 if not total else 1e-6}, "Fresnel's equations; critical angle asin(1/1.5)", wo=wo)
    for wo in [UP, SLANT, [0.8, 0, 0.6], [0, 0, -1], [0.3, 0.4, float(sqrt(mpf(3)) / 2)], [0.3, 0, -float(sqrt(mpf("0.91")))]]:
        for eta in [1.0, 1.0000001, 1.5, 2.4, 1 / 1.5]:
            if eta < 1 and wo[2] > 0 and abs(wo[0]) > 0.59:
                continue
            if eta > 1 and wo[2] < 0 and abs(wo[0]) * eta > 0.9:
                continue
            case(file, f"refracted by {eta:.7f} and back from {wo}", "rendering folklore: refract(refract(w)) loses the ray",
                 {"type": "dielectric", "ior": eta}, {"returns": 4e-6}, "Snell's law is its own inverse", wo=wo)
    for eta, k in [(1.5, 0.0), (1.0, 0.0), (1e-4, 0.0), (1.0, 100.0), (100.0, 100.0), (0.2, 3.9), (1e-4, 1e-4)]:
        for cos, wo, wi in [(mpf(1), UP, UP), (unit(vec(SLANT))[2], SLANT, MIRRORED)]:
            material = {"type": "conductor", "eta": grey(eta), "k": grey(k), "alpha": 0.3}
            r = reflector(wo, wi, 0.3, 0.3, lambda c: conductor(mpf(eta), mpf(k), min(c, mpf(1))))
            expect = value(r, 1e-4, 1e-8) if r > 1e-12 else {"finite": True, "f_cos_below": 1e-12}
            case(file, f"index {eta} - {k}i, wo {wo}", "k = 0 and huge k: cancellation in a^2 - b^2", material, expect,
                 "Fresnel's equations with a complex index, mpmath, 60 digits", wo=wo, wi=wi)
    for ior in [1.0, 1.5, 1 / 1.5]:
        material = {"type": "conductor", "ior": ior, "alpha": 0.3}
        r = reflector(UP, UP, 0.3, 0.3, lambda c: dielectric(mpf(ior), min(c, mpf(1))))
        expect = value(r, 1e-5) if r > 0 else {"finite": True, "f_cos_below": 1e-12}
        case(file, f"coat of index {ior}", origin, material, expect, "Fresnel's equations, mpmath, 60 digits", wo=UP, wi=UP)
    for f0 in [0.0, 1.0]:
        case(file, f"schlick of f0 {f0} along the normal", origin, metal(f0, alpha=0.3),
             value(f0 / (4 * pi * mpf(0.3) ** 2), 1e-5) if f0 else {"finite": True, "f_cos_below": 1e-30}, "closed form", wo=UP, wi=UP)


def reflectances():
    file = "reflectances"
    origin = "pbrt-v4#283, pbrt-v4#222: reflectance exactly 0 or 1, roughness exactly 0"
    slots = {"diffuse": ["base_color"], "eon": ["base_color"], "eon fitted": ["base_color"], "mirror": ["reflectance"], "ggx": ["f0"],
             "beckmann": ["f0"], "phong": ["diffuse", "glossy"]}
    for name, keys in slots.items():
        for key in keys:
            for slot in range(3):
                for x in [0.0, "-0.0", 1.0]:
                    colour = grey(0.0) if name == "phong" else grey(0.5)
                    colour[slot] = x
                    material = {**MODELS[name], key: colour}
                    if name == "phong":
                        material["glossy" if key == "diffuse" else "diffuse"] = grey(0.0)
                    case(file, f"{name}: {key}[{slot}] = {x}", origin, material, {"finite": True, "weight_at_most": 3.1},
                         "law: finite; a weight stays below 3 for three channels chosen by luminance", wo=SLANT, wi=MIRRORED)
                for x in [1.0000002, 1.5, -0.1, "nan", "inf", "-inf"]:
                    colour = grey(0.0)
                    colour[slot] = x
                    case(file, f"{name}: {key}[{slot}] = {x} lies outside of the domain", origin, {**MODELS[name], key: colour},
                         {"zero": True, "sample_fails": True}, "law: outside of the domain everything is zero", wo=SLANT, wi=MIRRORED)
    for r in [0.0, DENORMAL, 1e-12, 0.5, 1.0]:
        case(file, f"eon of roughness {r}", origin, {"type": "eon", "base_color": grey(1.0), "roughness": r},
             value(eon(SLANT, [0, 0.6, 0.8], 1, num(r)), 1e-5), "the paper's formula, mpmath, 60 digits", wo=SLANT, wi=[0, 0.6, 0.8])
    for name in MODELS:
        if name not in ["mirror", "glass"]:
            case(file, f"{name}: samples of white and black weigh at most 2", "NVIDIA Donut#23: a density without G1 makes weights wrong",
                 MODELS[name], {"weight_at_most": 1.6}, "law: F G2/G1 <= 1; EON 1.6 by its authors' sampler; Phong by its parts",
                 wo=SLANT, wi=MIRRORED)


def specials():
    file = "specials"
    origin = "bevy#21921, pbrt-v4#283: one NaN in, a firefly out"
    for name, model in MODELS.items():
        for x in ["nan", "inf", "-inf", DENORMAL, F32_MIN, "-0.0", 1e20, -1e20, 0.0]:
            for slot in range(3):
                wo = list(SLANT)
                wo[slot] = x
                length2 = sum(num(c) ** 2 for c in wo)
                outside = not abs(length2 - 1) <= mpf("0.0011")
                expect = {"zero": True} if outside else {"finite": True}
                how = "law: what is no direction gets exactly zero" if outside else "law: finite and not negative"
                case(file, f"{name}: wo[{slot}] = {x}", origin, model, expect, how, wo=wo, wi=MIRRORED)
                case(file, f"{name}: wi[{slot}] = {x}", origin, model, expect, how, wo=MIRRORED, wi=wo)
    for x in ["nan", "inf", "-inf", -1.0, 0.0, DENORMAL, 1e9]:
        for distribution in ["smooth", "rough"]:
            model = {"type": "dielectric", "ior": x, **({} if distribution == "smooth" else {"alpha": 0.3})}
            case(file, f"{distribution} glass of index {x} lies outside of the domain", origin, model,
                 {"zero": True, "sample_fails": True}, "law: outside of the domain everything is zero", wo=SLANT, wi=MIRRORED)


def conventions():
    file = "conventions"
    case(file, "diffuse is rho cos/pi", "raysect#349: a bsdf() without 1/pi", MODELS["diffuse"],
         {**value(mpf(0.8) * mpf(0.8) / pi, 1e-6), "pdf": float(mpf(0.8) / pi)}, "closed form: rho cos_i/pi, density cos_i/pi",
         wo=UP, wi=SLANT)
    case(file, "a mirror has no value", "raysect#349", MODELS["mirror"], {"zero": True}, "law: a delta is sampled, never evaluated",
         wo=SLANT, wi=MIRRORED)
    case(file, "a mirror mirrors", "raysect#349", MODELS["mirror"], {"equals_mirror": 1e-6, "weight": 0.9}, "law of reflection", wo=SLANT)
    wo, wi = SLANT, [0.0, -0.6, 0.8]
    gold = lambda c: schlick(mpf(0.9), c)
    case(file, "roughness 0.5 is alpha 0.25 in D and in G", "OloEngineBase#904: D used alpha, G used roughness",
         {"type": "conductor", "f0": grey(0.9), "roughness": 0.5}, value(reflector(wo, wi, 0.25, 0.25, gold), 1e-5),
         "Cook and Torrance, mpmath, 60 digits", wo=wo, wi=wi)
    for masking in ["correlated", "separable"]:
        for distribution in ["ggx", "beckmann"]:
            material = {**metal(0.9, alpha_x=0.2, alpha_y=0.6), "masking": masking, "distribution": distribution}
            case(file, f"{distribution}, {masking}", "three.js#8349, NVIDIA Donut#23: G forgotten or doubled", material,
                 value(reflector(wo, wi, 0.2, 0.6, gold, distribution, masking), 1e-5), "Cook and Torrance, mpmath, 60 digits", wo=wo, wi=wi)
            case(file, f"{distribution}, {masking}: the same way back", "mitsuba3#1779: may a model not be reciprocal?", material,
                 {"reciprocal": 4e-6}, "Helmholtz", wo=wo, wi=wi)
    turned = "glTF#2407, glTF-Sample-Viewer#555: anisotropy turned by 90 degrees"
    for axis, sharp in [(0, True), (1, False)]:
        wi = at(0.3, axis)
        case(file, f"alpha_x is the width along the tangent: h leans along {'xy'[axis]}", turned, metal(1.0, alpha_x=0.05, alpha_y=0.5),
             value(reflector(UP, wi, 0.05, 0.5, lambda c: mpf(1)), 1e-5), "Cook and Torrance, mpmath, 60 digits", wo=UP, wi=wi)
    for name in ["eon", "phong", "gold", "diffuse", "eon fitted"]:
        case(file, f"{name}: the same way back", "pbrt-v4#215: wo and wi swapped between f and Sample_f", MODELS[name], {"reciprocal": 4e-6},
             "Helmholtz", wo=SLANT, wi=[0.0, -0.8, 0.6])
    for norm in ["lecture", "lafortune"]:
        for exponent, wi in [(30.0, [-0.5, 0.1, float(sqrt(mpf("0.74")))]), (1e4, [-0.605, 0.0, float(sqrt(1 - mpf("0.605") ** 2))])]:
            material = {"type": "phong", "diffuse": grey(0.25), "glossy": grey(0.5), "exponent": exponent, "normalization": norm}
            case(file, f"phong {norm} of exponent {exponent:g}", "raysect#349: which normalisation?", material,
                 value(phong(SLANT, wi, mpf(0.25), mpf(0.5), mpf(exponent), norm), 1e-4, 1e-8),
                 "closed form by mpmath, 60 digits", wo=SLANT, wi=wi)
    case(file, "two lobes add", "three.js#32190, bevy#23203: mixing before or after the lobes",
         {"type": "mix", "lobes": [{"type": "diffuse", "base_color": grey(0.5), "weight": 0.5}, {**metal(1.0, alpha=0.3), "weight": 0.5}]},
         value((mpf(0.5) / pi + 1 / (4 * pi * mpf(0.3) ** 2)) / 2, 1e-5), "closed form: half of either", wo=UP, wi=UP)
    case(file, "an unknown type", "scene formats that ignore what they do not know", {"type": "velvet"}, {"refused": "velvet"},
         "rule: refused with its line")
    case(file, "a reflectance above 1", "mitsuba3#1155: energy", {"type": "diffuse", "base_color": grey(1.5)}, {"refused": "base_color"},
         "rule: refused with its line")


def frames():
    file = "frames"
    origin = "bevy#20191: an orthonormal basis that -0.0 turned over"
    normals = [[0, 0, 1], [0, 0, -1], ["-0.0", "-0.0", 1], ["-0.0", 0, -1], [1, 0, 0], [1, 0, "-0.0"], [0, 1, "-0.0"], [-1, "-0.0", "-0.0"],
               [1e-4, 0, -1], [1e-7, 1e-7, -1], [1, 1, 1], [-3, 4, -12], [0, 0, 1e-30], [1e-30, 0, -1e-30], [1e18, 1e18, -1e18],
               [DENORMAL, 0, 0], [0, 0, "0x3p-149"]]
    for n in normals:
        case(file, f"a frame from {n}", origin, {"type": "frame"}, {"frame": 2e-6, "keeps_normal": True},
             "law: orthonormal, right-handed, z along the normal", normal=n)
        for t, origin_t in [([1, 0, 0], origin), ([0.3, -0.9, 0.2], "glTF-Sample-Models#174: handedness flips"),
                            (n, "MikkTSpace#1: a tangent along the normal"), ([0, 0, 0], "MikkTSpace#1: no tangent at all"),
                            (["nan", 0, 1], "bevy#20191: a tangent that is NaN")]:
            case(file, f"a frame from {n} with tangent {t}", origin_t, {"type": "frame"}, {"frame": 2e-6, "keeps_normal": True},
                 "law: orthonormal, right-handed, z along the normal whatever the tangent", normal=n, tangent=t)
    for n in [[0, 0, 0], ["nan", 0, 1], ["inf", 0, 0]]:
        case(file, f"a frame from {n}, which is no normal", origin, {"type": "frame"}, {"frame": 2e-6},
             "law: orthonormal and right-handed, come what may", normal=n)


for make in [grazing, narrow, alignment, fresnel, reflectances, specials, conventions, frames]:
    make()
total = 0
for file, cases in FILES.items():
    if file == "frames":
        for c in cases:
            del c["material"]
            c["kind"] = "frame"
    with open(os.path.join(HERE, file + ".json"), "w") as out:
        out.write("[\n" + ",\n".join(json.dumps(c) for c in cases) + "\n]\n")
    total += len(cases)
print(total, "cases in", len(FILES), "files")
