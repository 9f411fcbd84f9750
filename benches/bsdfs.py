"""Scattering models side by side: Mitsuba 3's (llvm_ad_rgb) and Gonio's (eight lanes), in one thread on one core.

The two take turns in rounds of some tens of milliseconds, because the speed of a machine drifts: the ratio of neighbours is
the result, the absolute figures are not. A turn is worth its median pass over the batch, which no other program interrupted. Each works on 4096 pairs of directions, uniform over the hemisphere (over the sphere
for what a dielectric scatters), which it reads from and writes to arrays within the second-level cache.

Mitsuba's time is that of the kernels alone, by Dr.Jit's own kernel history: tracing and launching are not in it. Its
parameters are arrays (dr.make_opaque) as Gonio's are black boxes, so neither compiler folds them. It computes in as many lanes as
its LLVM back end finds: 16 where there is AVX-512. Gonio's are the rows of
benches/serve.rs, in the process that `cargo bench --bench kernel -- --serve` starts.

Mitsuba has no Schlick or F82 metal: those rows stand beside its exact one, as an artist's choice would. Gonio's masking is
height-correlated, Mitsuba's separable; Gonio's Beckmann masking is exact, Mitsuba's a rational fit.

    pip install mitsuba==3.9.1 numpy
    DRJIT_LIBLLVM_PATH=<libLLVM 19> python benches/bsdfs.py [--rounds 15] [--only ggx]
"""

import argparse
import os
import subprocess
from pathlib import Path
from statistics import median

ROOT = Path(__file__).resolve().parent.parent
BATCH = 4096
SLICE = 20e6  # nanoseconds of a turn
# Gonio's row, Mitsuba's model and question, least ratio that is claimed
ROWS = [
    ("lambert-eval", "diffuse", "eval", None),
    ("ggx-schlick-eval", "ggx", "eval", 2.0),
    ("ggx-f82-eval", "ggx", "eval", 2.0),
    ("ggx-exact-eval", "ggx", "eval", 1.3),
    ("ggx-pdf", "ggx", "pdf", 1.5),
    ("ggx-sample", "ggx", "sample", 2.0),
    ("ggx-weight", "ggx", "weight", None),
    ("beckmann-exact-eval", "beckmann", "eval", None),
    ("beckmann-pdf", "beckmann", "pdf", None),
    ("beckmann-sample", "beckmann", "sample", 4.0),
    ("beckmann-weight", "beckmann", "weight", None),
    ("dielectric-eval", "dielectric", "eval", None),
    ("dielectric-pdf", "dielectric", "pdf", None),
    ("dielectric-sample", "dielectric", "sample", None),
    ("dielectric-weight", "dielectric", "weight", None),
]


class Mitsuba:
    def __init__(self):
        import drjit as dr
        import mitsuba as mi
        import numpy as np

        mi.set_variant("llvm_ad_rgb")
        dr.set_thread_count(1)
        self.dr, self.mi, self.context = dr, mi, mi.BSDFContext()
        rng = np.random.default_rng(1)

        def directions(both_sides):
            z, phi = rng.uniform(1e-3, 1, BATCH), rng.uniform(0, 2 * np.pi, BATCH)
            r = np.sqrt(1 - z * z)
            side = rng.choice([-1, 1], BATCH) if both_sides else 1
            return mi.Vector3f(r * np.cos(phi), r * np.sin(phi), side * z)

        self.wo, self.wi, self.wi_any = directions(False), directions(False), directions(True)
        self.u, self.v = mi.Float(rng.uniform(size=BATCH)), mi.Point2f(rng.uniform(size=(2, BATCH)))
        dr.make_opaque(self.wo, self.wi, self.wi_any, self.u, self.v)
        self.hit = dr.zeros(mi.SurfaceInteraction3f, BATCH)
        self.hit.wi = self.wo
        rgb = lambda *value: {"type": "rgb", "value": list(value)}
        widths = {"alpha_u": 0.3, "alpha_v": 0.2}
        copper = {"eta": rgb(0.22, 0.96, 1.17), "k": rgb(3.68, 2.59, 2.46)}
        rough = lambda distribution: {"type": "roughconductor", "distribution": distribution} | widths | copper
        self.models = {
            "diffuse": self.opaque({"type": "diffuse", "reflectance": rgb(0.8, 0.5, 0.2)}),
            "ggx": self.opaque(rough("ggx")),
            "beckmann": self.opaque(rough("beckmann")),
            "dielectric": self.opaque({"type": "roughdielectric", "distribution": "ggx", "int_ior": 1.5, "ext_ior": 1.0} | widths),
        }

    def opaque(self, description):
        bsdf = self.mi.load_dict(description)
        parameters = self.mi.traverse(bsdf)
        for name in parameters.keys():
            value = parameters[name]
            self.dr.make_opaque(value)
            parameters[name] = value
        parameters.update()
        return bsdf

    def answer(self, model, question):
        """Evaluates the arrays that were asked for, and nothing that is not needed for them."""
        bsdf = self.models[model]
        wi = self.wi_any if model == "dielectric" else self.wi
        if question == "eval":
            self.dr.eval(bsdf.eval(self.context, self.hit, wi))
        elif question == "pdf":
            self.dr.eval(bsdf.pdf(self.context, self.hit, wi))
        else:
            sample, weight = bsdf.sample(self.context, self.hit, self.u, self.v)
            valid = sample.wo.z > 0 if model != "dielectric" else sample.pdf > 0
            self.dr.eval(*((sample.wo, valid) if question == "sample" else (sample.wo, weight, sample.pdf)))

    def nanoseconds(self, model, question, passes):
        """Per direction, in the median of so many launches."""
        dr = self.dr
        with dr.scoped_set_flag(dr.JitFlag.KernelHistory, True):
            dr.kernel_history_clear()
            for _ in range(passes):
                self.answer(model, question)
            dr.sync_thread()
            milliseconds = [kernel["execution_time"] for kernel in dr.kernel_history([dr.KernelType.JIT])]
        if len(milliseconds) != passes:
            raise SystemExit(f"{model} {question}: {len(milliseconds)} kernels in {passes} launches")
        return median(milliseconds) * 1e6 / BATCH


class Gonio:
    def __init__(self):
        cargo = os.environ.get("CARGO", "cargo")
        self.process = subprocess.Popen(
            [cargo, "bench", "--quiet", "--bench", "kernel", "--", "--serve"],
            cwd=ROOT, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
        )

    def nanoseconds(self, row, passes):
        self.process.stdin.write(f"{row} {passes}\n")
        self.process.stdin.flush()
        return float(self.process.stdout.readline())


def quartiles(values):
    ordered = sorted(values)
    return [ordered[round(share * (len(ordered) - 1))] for share in (0.25, 0.5, 0.75)]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=15)
    parser.add_argument("--only", default="", help="rows whose name contains this")
    args = parser.parse_args()

    os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})  # inherited by the threads of Mitsuba and by Gonio
    mitsuba, gonio = Mitsuba(), Gonio()
    print(f"{'ns per direction':22} Mitsuba   Gonio   ratio  quartiles      claimed")
    short = []
    for row, model, question, claim in ROWS:
        if args.only not in row:
            continue
        ask = (lambda n: mitsuba.nanoseconds(model, question, n)), (lambda n: gonio.nanoseconds(row, n))
        ask[0](1)  # compiles the kernel, which is kept
        # How many passes make a turn; tracing takes Mitsuba longer than its kernels.
        passes = [max(10, int(SLICE / (BATCH * one(30)))) for one in ask]
        passes[0] = min(passes[0], 100)
        rounds = [[one(n) for one, n in zip(ask, passes)] for _ in range(args.rounds)]
        low, ratio, high = quartiles([theirs / ours for theirs, ours in rounds])
        theirs, ours = (quartiles(column)[1] for column in zip(*rounds))
        verdict = "" if claim is None else f">= {claim}" + ("" if ratio >= claim else "  NOT MET")
        print(f"{row:22} {theirs:7.2f} {ours:7.2f} {ratio:7.2f}  {low:.2f} to {high:.2f}  {verdict}", flush=True)
        if claim is not None and ratio < claim:
            short.append(row)
    gonio.process.stdin.close()
    if short:
        raise SystemExit("short of what is claimed: " + ", ".join(short))


if __name__ == "__main__":
    main()
