# SPDX-License-Identifier: Apache-2.0
"""A forceps that draws an organ's rim out and keeps it there."""
import csv
import math
import subprocess
from dataclasses import dataclass


@dataclass
class DrawnOut:
    jaws: list  # N, of each jaw at the end
    pull: float  # N, of both together at the end
    most: float  # N, the largest before
    step: float  # N, the largest change of it in a tick


def draw_out(programs, asset, log, millimetres, *options):
    """`palpate touch` with a forceps at the rim that it chooses, until shortly before it goes back."""
    inwards = 2.85  # s: to go in, close and hold, and to hold again
    done = subprocess.run([programs / "palpate-touch", asset, "--instrument", "forceps", "--depth", str(millimetres), "--seconds",
                           str(inwards + millimetres / 20), "--virtual-clock", "--log", log, "--force", *options],
                          capture_output=True, text=True, timeout=250)
    if done.returncode:
        raise RuntimeError(done.stderr)
    with open(log, newline="") as file:
        rows = list(csv.DictReader(file))
    forces = [[[float(row[f"force_{axis}_n"]) for axis in "xyz"] for row in rows if row["tool"] == jaw] for jaw in "01"]
    hand = [[a + b for a, b in zip(*jaws)] for jaws in zip(*forces)]
    return DrawnOut(jaws=[math.hypot(*jaw[-1]) for jaw in forces], pull=math.hypot(*hand[-1]), most=max(math.hypot(*force) for force in hand),
                    step=max(math.dist(*ticks) for ticks in zip(hand, hand[1:])))
