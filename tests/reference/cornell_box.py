"""Mitsuba 3's picture of its Cornell box, the reference for scenes/cornell-box.toml.

Writes cornell_box.json beside this file, whose fields pictures.py explains: means over 8 x 8 pixel blocks, with the
variance that says how far another correct renderer may be from them. Box filter, 8 scattering events (Mitsuba's
max_depth counts the emitter too: 9), no Russian roulette, independent samples.

    lamp_back       the blocks that the back of the lamp lights, if it reflects

Mitsuba's diffuse surfaces are black from behind, which matters for the lamp alone: 1 cm under the ceiling,
a lamp that is white on both sides makes the ceiling along its front edge 1 to 2 % brighter (`lamp_back`,
measured), and the whole picture by 2 parts in 10,000 in red, less in green and blue.

    pip install mitsuba==3.9.1 numpy
    DRJIT_LIBLLVM_PATH=<libLLVM 19> python cornell_box.py [threads]
"""

import sys
from pathlib import Path

import drjit as dr
import mitsuba as mi

mi.set_variant("llvm_ad_rgb")

from pictures import write  # after the variant is set

SIZE, SPP, SEEDS = 256, 64, 16
MAX_DEPTH = 9  # 8 scattering events
NO_ROULETTE = 1000  # the depth at which roulette would begin
LAMP_BACK = range(3 * 32 + 13, 3 * 32 + 19)  # found by comparing with a two-sided lamp


def scene():
    box = mi.cornell_box()
    box["integrator"].update(max_depth=MAX_DEPTH, rr_depth=NO_ROULETTE)
    box["sensor"]["film"].update(width=SIZE, height=SIZE, rfilter={"type": "box"})
    return mi.load_dict(box, optimize=False)  # optimizing merges shapes of one material, and hides silhouettes


def main():
    dr.set_thread_count(int(sys.argv[1]) if len(sys.argv) > 1 else 1)
    out = Path(__file__).with_suffix(".json")
    write(out, "cornell_box()", scene(), SIZE, SIZE, SPP, SEEDS, MAX_DEPTH, lamp_back=list(LAMP_BACK))


if __name__ == "__main__":
    main()
