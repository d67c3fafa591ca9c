# SPDX-License-Identifier: Apache-2.0
"""A forceps that draws an organ's rim out and back, by `palpate touch`, and what becomes of its hold."""
import json
import subprocess
from dataclasses import dataclass

import numpy as np


@dataclass
class DrawnOut:
    told: dict  # the run's JSON
    millimetres: float  # how far the closed jaws went
    pull: float  # N, on the hand that holds both jaws, at the end of the rest where they went to
    most: float  # N, while they are closed
    step: float  # N, its largest change in a tick then
    lost: float | None  # mm from where they closed, when a jaw felt nothing


def draw_out(programs, asset, folder, millimetres, *options, speed=20.0):
    """At the rim that the forceps chooses. Throws RuntimeError with what touch said, where it refuses."""
    log = folder / "drawn.csv"
    done = subprocess.run([programs / "palpate-touch", asset, "--instrument", "forceps", "--depth", str(millimetres), "--speed", str(speed),
                           "--seconds", str(4 + millimetres / speed), "--virtual-clock", "--log", log, "--force", "--quiet", "--json", "-", *options],
                          capture_output=True, text=True, timeout=250)
    if done.returncode:
        raise RuntimeError(done.stderr.strip())
    columns = log.open().readline().strip().split(",")
    wanted = [columns.index(f"{what}_{axis}_{unit}") for what, unit in (("device", "mm"), ("force", "n")) for axis in "xyz"]
    rows = np.loadtxt(log, delimiter=",", skiprows=1, usecols=wanted).reshape(-1, 2, 6)  # by tick and jaw
    place, force = rows[..., :3], rows[..., 3:]
    apart = np.linalg.norm(place[:, 0] - place[:, 1], axis=1)
    closed = np.flatnonzero(apart < apart.min() + 1e-3)
    drawn = np.linalg.norm(place[closed, 0] - place[closed[0], 0], axis=1)
    hand = force.sum(axis=1)[closed]
    nothing = np.flatnonzero((np.linalg.norm(force[closed], axis=2) == 0).any(axis=1))
    there = np.flatnonzero(drawn > drawn.max() - 1e-3)[-1]
    return DrawnOut(told=json.loads(done.stdout), millimetres=drawn.max(), pull=np.linalg.norm(hand[there]), most=np.linalg.norm(hand, axis=1).max(),
                    step=np.linalg.norm(np.diff(hand, axis=0), axis=1).max(), lost=drawn[nothing[0]] if len(nothing) else None)
