#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Rims that a forceps draws out: how far they are held, what that takes, and what its ticks take.

    grasps.py ASSET ... [--depth MM] [--speed MM/S] [--jaw-length MM]      (PALPATE_BIN has the programs)

The script `grasp` of palpate touch, once, at the rim that it chooses, of linear tissue and with `--large-deformation`. Step: the largest
change in a tick of the force on the hand that holds both jaws, of the largest force, from closing the jaws to opening them. Lost: how far
it was drawn, on its way out or back, when a jaw felt nothing. The ticks are this machine's, one core for them; all else is of virtual time.
"""
import argparse
import os
import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "commands"))
from drawn_out import draw_out  # noqa: E402

PROGRAMS = pathlib.Path(os.environ.get("PALPATE_BIN", "build/release/bin"))
HEAD = """| case | tissue | rim, mm | drawn out, mm | force, N | largest step | lost at, mm | ticks p50 / p99 / p99.9, us |
|---|---|--:|--:|--:|--:|--:|--:|"""


def row(asset, tissue, drawn):
    ticks = " / ".join(f"{drawn.told['tick_us'][key]:.0f}" for key in ("p50", "p99", "p99_9"))
    lost = "held" if drawn.lost is None else f"{drawn.lost:.1f}"
    return (f"| {asset.stem} | {tissue} | {drawn.told['grasp']['thickness_mm']:.1f} | {drawn.millimetres:.0f} | {drawn.most:.2f} | "
            f"{100 * drawn.step / drawn.most:.1f} % | {lost} | {ticks} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("assets", type=pathlib.Path, nargs="+")
    parser.add_argument("--depth", type=float, default=20)
    parser.add_argument("--speed", type=float, default=20)
    parser.add_argument("--jaw-length", type=float, default=20)
    arguments = parser.parse_args()
    print(HEAD, flush=True)
    with tempfile.TemporaryDirectory() as folder:
        for asset in arguments.assets:
            for tissue, bodies in (("linear", "none"), ("neo-Hookean", "all")):
                drawn = draw_out(PROGRAMS, asset, pathlib.Path(folder), arguments.depth, "--large-deformation", bodies, "--jaw-length",
                                 str(arguments.jaw_length), speed=arguments.speed)
                print(row(asset, tissue, drawn), flush=True)


if __name__ == "__main__":
    main()
