#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Presses of neo-Hookean tissue: how far a moving hand's force is from that at rest, and linear tissue's beside it.

    large_presses.py ASSET [--depth MM] [--places N]      (PALPATE_BIN has the programs)

At the places of closed_loops.py a hand presses at 50 mm/s and holds for 1.2 s, with `--large-deformation`, and step by step, held for 0.8 s
at each quarter of the depth, with and without. Moving, linear: largest difference of the force at the quarters from that at rest there.
Held: after 0.3 s from the end. Virtual time: the figures are the same on every machine.
"""
import argparse
import pathlib
import subprocess
import tempfile

import numpy as np
from closed_loops import PALPATE, logged, places

HEAD = """| case | deep, mm | force, N | moving | linear | held | largest step while held |
|---|--:|--:|--:|--:|--:|--:|"""
QUARTERS = np.array([0.25, 0.5, 0.75, 1])
SPEED, CLEAR = 50, 5  # mm/s; mm above the surface, where it sets out
REACH, HOLD, END = 0.25, 0.8, 1.2  # s: to the next quarter, there; and at the end of the fast one


def forces(asset, folder, keys, large):
    """Force of every tick (N) along rows (s, p)."""
    (folder / "hand.txt").write_text("".join("%.6f %.9g %.9g %.9g\n" % (t, *p) for t, p in keys))
    subprocess.run([PALPATE, "touch", asset, "--script", folder / "hand.txt", "--virtual-clock", "--log", folder / "log.csv", "--quiet", "--force",
                    *(["--large-deformation", "all"] if large else [])], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    (force,) = logged(folder / "log.csv", "force_?_n")
    return force


def press(asset, folder, point, inward, radius, depth):
    """Largest part by which the force is off: moving, of linear tissue, held, and its largest step while held."""
    at = lambda deep: point + inward * (deep - radius)
    tick = lambda time: np.round(1000 * time).astype(int) - 1
    begin = CLEAR / SPEED
    slow = [(0, at(-CLEAR)), (begin, at(0))]
    for k, part in enumerate(QUARTERS):
        slow += [(begin + k * (REACH + HOLD) + REACH, at(part * depth)), (begin + (k + 1) * (REACH + HOLD), at(part * depth))]
    rested = tick(begin + np.arange(1, 5) * (REACH + HOLD)) - 10
    rest, linear = (np.linalg.norm(forces(asset, folder, slow, large)[rested], axis=1) for large in (True, False))
    there = begin + depth / SPEED
    moving = forces(asset, folder, [(0, at(-CLEAR)), (there, at(depth)), (there + END, at(depth))], True)
    passed = np.linalg.norm(moving[tick(begin + QUARTERS * depth / SPEED)], axis=1)
    end, held = np.linalg.norm(moving[-1]), moving[tick(np.array(there)) + 2:]
    return [abs(passed / rest - 1).max(), abs(linear / rest - 1).max(), np.linalg.norm(moving[tick(np.array(there + 0.3))] - moving[-1]) / end,
            np.linalg.norm(np.diff(held, axis=0), axis=1).max() / end, end]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("asset", type=pathlib.Path)
    parser.add_argument("--depth", type=float, default=12.0)
    parser.add_argument("--places", type=int, default=12)
    arguments = parser.parse_args()
    chosen, radius = places(arguments.asset, arguments.places, circle=3, held=False, edges=False)
    with tempfile.TemporaryDirectory() as folder:
        found = np.array([press(arguments.asset, pathlib.Path(folder), *place, radius, arguments.depth) for place in chosen])
    print(HEAD)
    print(f"| {arguments.asset.stem} | {arguments.depth:g} | {found[:, 4].min():.2f} to {found[:, 4].max():.2f} | " +
          " | ".join(f"{np.median(values):.2g} / {values.max():.2g} %" for values in 100 * found[:, :4].T) + " |")


if __name__ == "__main__":
    main()
