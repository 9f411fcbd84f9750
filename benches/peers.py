"""W1, side by side: the diffuse Cornell box in Mitsuba 3 (llvm_ad_rgb) and in Gonio, in one thread on one core.

512 x 512, box filter, 8 scattering events, light sampling with MIS at each, no Russian roulette. The two
take turns, A B A B, because the speed of a machine drifts: the ratio of neighbours is the result, the
absolute figures are not. Only rendering is timed: neither loading, nor compiling, nor writing the picture.

    pip install mitsuba==3.9.1
    cargo build --release
    DRJIT_LIBLLVM_PATH=<libLLVM 19> python benches/peers.py --gonio target/release/gonio [--rounds 5] [--spp 32]

Without --gonio only Mitsuba is timed. Older versions of LLVM abort while they compile its kernel.
"""

import argparse
import json
import os
import subprocess
import tempfile
import time
from pathlib import Path
from statistics import median

SCENE = Path(__file__).resolve().parent.parent / "scenes" / "cornell-box.toml"
SIZE = 512
MAX_DEPTH = 9  # Mitsuba counts the emitter too: 8 scattering events
NO_ROULETTE = 1000  # the depth at which roulette would begin


class Mitsuba:
    name = "Mitsuba"

    def __init__(self, spp):
        import drjit
        import mitsuba

        mitsuba.set_variant("llvm_ad_rgb")
        drjit.set_thread_count(1)
        box = mitsuba.cornell_box()
        box["integrator"].update(max_depth=MAX_DEPTH, rr_depth=NO_ROULETTE)
        box["sensor"]["film"].update(width=SIZE, height=SIZE, rfilter={"type": "box"})
        self.dr, self.mi, self.spp = drjit, mitsuba, spp
        self.scene = mitsuba.load_dict(box)
        self.msamples_per_second(seed=0)  # compiles the kernel, which is kept

    def msamples_per_second(self, seed):
        self.dr.sync_thread()
        start = time.perf_counter()
        self.dr.eval(self.mi.render(self.scene, spp=self.spp, seed=seed))
        self.dr.sync_thread()
        return SIZE * SIZE * self.spp / (time.perf_counter() - start) / 1e6


class Gonio:
    name = "Gonio"

    def __init__(self, binary, spp):
        self.binary, self.spp = Path(binary).resolve(), spp

    def msamples_per_second(self, seed):
        del seed  # Gonio takes none; the work is the same each time
        with tempfile.TemporaryDirectory() as scratch:
            stats = Path(scratch) / "stats.json"
            subprocess.run(
                [self.binary, "render", SCENE, "-o", Path(scratch) / "w1.exr", "--spp", str(self.spp),
                 "--threads", "1", "--no-russian-roulette", "--no-layers", "--stats", stats],
                check=True, stdout=subprocess.DEVNULL,
            )
            measured = json.loads(stats.read_text())
        return measured["samples"] / measured["render_seconds"] / 1e6


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--gonio", metavar="PATH", help="the Gonio binary")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--spp", type=int, default=32)
    args = parser.parse_args()

    os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})  # inherited by the thread of Mitsuba and by Gonio
    contestants = [Mitsuba(args.spp)] + ([Gonio(args.gonio, args.spp)] if args.gonio else [])

    rounds = []
    print("Msamples/s " + " ".join(f"{c.name:>9}" for c in contestants))
    for i in range(args.rounds):
        rounds.append([c.msamples_per_second(seed=i + 1) for c in contestants])
        print(f"round {i + 1:<5}" + " ".join(f"{speed:9.3f}" for speed in rounds[-1]), flush=True)
    print("median     " + " ".join(f"{median(column):9.3f}" for column in zip(*rounds)))
    if args.gonio:
        print(f"Gonio / Mitsuba, median of the pairs: {median(gonio / mitsuba for mitsuba, gonio in rounds):.2f}")


if __name__ == "__main__":
    main()
