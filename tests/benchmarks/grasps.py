#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Rims that a forceps draws out: how far they are held, what that takes, and what its ticks take.

    grasps.py ASSET ... [--depth MM] [--speed MM/S] [--jaw-length MM]      (PALPATE_BIN has the programs)

The script `grasp` of palpate touch, once, at the rim that it chooses, of linear tissue and with `--large-deformation`. Step: the largest
change in a tick of the force on the hand that holds both jaws, of the largest force, from closing the jaws to opening them. Lost: how far
it was drawn when a jaw felt nothing. The ticks are this machine's, one core for them; all else is of virtual time.
"""
import argparse
import json
import os
import pathlib
import subprocess
import tempfile

import numpy as np
from closed_loops import logged

TOUCH = pathlib.Path(os.environ.get("PALPATE_BIN", "build/release/bin")) / "palpate-touch"
HEAD = """| case | tissue | rim, mm | drawn out, mm | force, N | largest step | lost at, mm | ticks p50 / p99 / p99.9, us |
|---|---|--:|--:|--:|--:|--:|--:|"""


def grasp(asset, folder, arguments, large):
    """A row of the table."""
    seconds = 4 + arguments.depth / arguments.speed
    done = subprocess.run([TOUCH, asset, "--instrument", "forceps", "--virtual-clock", "--depth", str(arguments.depth), "--speed", str(arguments.speed),
                           "--jaw-length", str(arguments.jaw_length), "--seconds", str(seconds), "--log", folder / "log.csv", "--force", "--quiet",
                           "--json", folder / "touch.json", "--large-deformation", "all" if large else "none"], capture_output=True, text=True)
    tissue = "neo-Hookean" if large else "linear"
    if done.returncode:
        return f"| {asset.stem} | {tissue} | {done.stderr.strip().split(': ', 2)[-1].split(';')[0]} | | | | | |"
    told = json.loads((folder / "touch.json").read_text())
    place, force = (np.stack([rows[0::2], rows[1::2]]) for rows in logged(folder / "log.csv", "device_?_mm", "force_?_n"))
    apart = np.linalg.norm(place[0] - place[1], axis=1)
    closed = np.flatnonzero(apart < apart.min() + 1e-3)
    drawn = np.linalg.norm(place[0] - place[0][closed[0]], axis=1)
    held = np.linalg.norm(force, axis=2).min(axis=0) > 0
    lost = [k for k in closed if not held[k]]
    hand = force.sum(axis=0)[closed]
    most = np.linalg.norm(hand, axis=1).max()
    step = np.linalg.norm(np.diff(hand, axis=0), axis=1).max() / most
    ticks = " / ".join(f"{told['tick_us'][key]:.0f}" for key in ("p50", "p99", "p99_9"))
    return (f"| {asset.stem} | {tissue} | {told['grasp']['thickness_mm']:.1f} | {drawn[closed].max():.0f} | {most:.2f} | {100 * step:.1f} % | "
            f"{f'{drawn[lost[0]]:.1f}' if lost else 'held'} | {ticks} |")


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
            for large in (False, True):
                print(grasp(asset, pathlib.Path(folder), arguments, large), flush=True)


if __name__ == "__main__":
    main()
