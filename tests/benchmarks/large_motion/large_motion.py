#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Large motions of neo-Hookean tissue in palpate touch beside CalculiX: a press, a retraction by a forceps, a beam that is bent.

    large_motion.py LIVER      (LIVER: the demo's asset; PALPATE_BIN has the programs, PALPATE_BUILD judge_by_calculix; needs calculix-ccx)

The hand moves at 50 mm/s and rests; with `--large-deformation`, on a virtual clock. What CalculiX makes of the same forces on the same mesh
is the truth: while the hand moves, at a half, three quarters and the end of its way, and 0.3 s after. Force: by how much more or less the
tissue gives way to these forces, along them, which is how far off a force is that is asked for at the same place. Surface: the largest
difference of a vertex' displacement, of the largest displacement. Prints one table.
"""
import argparse
import json
import os
import pathlib
import subprocess
import sys
import tempfile

import h5py
import numpy as np

BENCHMARKS = pathlib.Path(__file__).resolve().parents[1]
sys.path[:0] = [str(BENCHMARKS), str(BENCHMARKS.parent / "commands")]
from closed_loops import PALPATE, places  # noqa: E402
from nifti import TYPES, write_nifti  # noqa: E402

JUDGE = pathlib.Path(os.environ.get("PALPATE_BUILD", "build/release")) / "tests" / "judge_by_calculix"
SPEED, REST, PINCH, JAW, JAW_RADIUS, OPEN = 50.0, 0.3, 0.75, 20.0, 2.5, 60.0  # mm/s; s; of the thickness; mm; mm; degrees
ROWS = """| motion | force, N | largest displacement, mm | turned by, degrees | moving: force off by | surface | at rest: force | surface | linear, at rest: force | surface |
|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|"""
BEAM = """schema = 1
name = "beam"
[input]
labels = "beam.nii"
[[structure]]
name = "beam"
recipe = "import"
label = "1"
[[deformable]]
name = "beam"
mesh = { cell_size_mm = 5, facet_distance_mm = 0.3 }
fixed = [{ box_mm = [-1, -1, -1, 21, 31, 2.6] }]
[[deformable.region]]
label = "beam"
youngs_modulus_kpa = 20
poissons_ratio = 0.45
[haptics]
tool_radius_mm = 5
friction_at_rest = 0.5
friction_sliding = 0.5
[quality]
max_mean_distance_mm = 0.5
max_p95_distance_mm = 1.5
max_distance_voxel_diagonals = 2.0
min_dice = 0.9
"""


def forces_off(asset, folder, rows, forceps, moving, rest):
    """What the judge says of ticks while moving, and of one at rest; rows are `t x y z` or of a forceps."""
    np.savetxt(folder / "hand.txt", rows, "%.9g")
    subprocess.run([PALPATE, "touch", asset, "--script", folder / "hand.txt", "--virtual-clock", "--large-deformation", "all", "--record", folder / "run.h5",
                    "--quiet", "--force", *(["--instrument", "forceps"] if forceps else [])], check=True, stdout=subprocess.DEVNULL)
    ticks = [int(round(1000 * time)) - 1 for time in (*moving, rest)]
    told = subprocess.run([JUDGE, asset, folder / "run.h5", *map(str, ticks)], check=True, capture_output=True, text=True).stdout
    found = {int(tick): [float(x) for x in figures] for tick, *figures, _ in (line.split(maxsplit=8) for line in told.splitlines())}
    if missing := [tick for tick in ticks if tick not in found]:
        raise SystemExit(f"nothing is pressed in the ticks {missing} of {folder / 'run.h5'}")
    return [found[tick] for tick in ticks[:-1]], found[ticks[-1]]


def row(name, moving, rest):
    force, way, turn, *off = rest
    worst = np.array(moving)[:, 3:5].max(axis=0)
    return (f"| {name} | {force:.2f} | {way:.1f} | {turn:.0f} | {worst[0]:.1f} % | {worst[1]:.1f} % | {off[0]:.1f} % | {off[1]:.1f} % | {off[2]:.1f} % | "
            f"{off[3]:.1f} % |")


def thickness(asset, point, inward):
    """From a point of the surface straight through, mm."""
    with h5py.File(asset) as file:
        body = file["palpate/bodies/deformable/0"]
        a, b, c = np.moveaxis(body["rest_positions"][...][body["surface_nodes"][...][body["surface_triangles"][...]]], 1, 0)
    p = np.cross(inward, c - a)
    across = (p * (b - a)).sum(1)
    with np.errstate(divide="ignore", invalid="ignore"):
        u = (p * (point - a)).sum(1) / across
        q = np.cross(point - a, b - a)
        v, way = (q @ inward) / across, ((c - a) * q).sum(1) / across
    return way[(u >= 0) & (v >= 0) & (u + v <= 1) & (way > 1)].min()


def press(asset, folder):
    """A quarter of the thickness, where that is least of twelve places."""
    chosen, radius = places(asset, 12, circle=3, held=False, edges=False)
    thick, point, inward = min(((thickness(asset, *place), *place) for place in chosen), key=lambda one: one[0])
    at = lambda deep: point + inward * (deep - radius)
    deep, begin = thick / 4, 5 / SPEED
    there = begin + deep / SPEED
    rows = [(0, *at(-5)), (there, *at(deep)), (there + 2 * REST, *at(deep))]
    return row(f"press of {deep:.1f} mm, a quarter of {thick:.0f} mm", *forces_off(
        asset, folder, rows, False, [begin + part * deep / SPEED for part in (0.5, 0.75, 1)], there + REST))


def drawn_out(grasp, millimetres):
    """Rows of a forceps that goes in, closes, holds, draws the tissue out along its shaft and rests; when it sets out and ends."""
    meet, orientation, thick, deep = (np.array(grasp[key]) for key in ("meet_mm", "orientation", "thickness_mm", "depth_mm"))
    x, y, z, w = orientation
    shaft = np.array([2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)])
    closed = np.degrees(2 * np.arcsin((1 - PINCH) * thick / (2 * JAW)))
    rows = [(0, *(meet + 2 * deep * shaft), *orientation, OPEN), (0.5, *meet, *orientation, OPEN), (1.5, *meet, *orientation, closed),
            (2, *meet, *orientation, closed)]
    end, away = 2 + millimetres / SPEED, (*(meet + shaft * millimetres), *orientation, closed)
    return [*rows, (end, *away), (end + 2 * REST, *away)], 2, end


def retract(asset, folder, millimetres=20):
    """The forceps draws the rim that it chooses itself out along its shaft."""
    done = subprocess.run([PALPATE, "touch", asset, "--instrument", "forceps", "--virtual-clock", "--seconds", "0.01", "--quiet", "--json", "-"],
                          check=True, capture_output=True, text=True)
    rows, begin, end = drawn_out(json.loads(done.stdout)["grasp"], millimetres)
    return row(f"retraction of {millimetres} mm", *forces_off(
        asset, folder, rows, True, [begin + part * (end - begin) for part in (0.5, 0.75, 1)], end + REST))


def bend(folder):
    """A beam of 20 x 30 x 100 mm, held at one end, pressed aside near the other until it is bent by 45 degrees there.

    The tool goes with the place that it presses, as an end-loaded cantilever's goes that is bent so far: by 0.494 of its length aside and
    0.161 back (Bisshopp, Drucker 1945, Large deflection of cantilever beams, Q Appl Math 3, 272)."""
    size, step = (8, 12, 40), 2.5
    grid = np.zeros(np.array(size) + 2, np.uint8)
    grid[1:-1, 1:-1, 1:-1] = 1
    # The first voxel of the beam begins at 0.
    write_nifti(folder / "beam.nii", grid.shape, [[step if a == r else 0 for a in range(3)] + [-step / 2] for r in range(3)],
                grid.tobytes(order="F"), TYPES["uint8"])
    (folder / "beam.toml").write_text(BEAM)
    asset = folder / "beam.vtkhdf"
    subprocess.run([PALPATE, "build", folder / "beam.toml", "-o", asset, "--quiet"], check=True, stdout=subprocess.DEVNULL)
    length, radius, axis = 85.0, 5.0, np.array([10, 15, 0])

    def centre(part, clear=0):
        turn = 0.782 * part
        return (axis + length * np.array([-0.494 * part, 0, 1 - 0.161 * part**2]) +
                (10 + radius + clear) * np.array([np.cos(turn), 0, np.sin(turn)]))

    parts = np.linspace(0, 1, 401)
    way = np.array([centre(part) for part in parts])
    times = 0.1 + np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(way, axis=0), axis=1))]) / SPEED
    rows = [(0, *centre(0, 0.1 * SPEED)), *((t, *p) for t, p in zip(times, way)), (times[-1] + 2 * REST, *way[-1])]
    return row("beam bent by 45 degrees", *forces_off(asset, folder, rows, False, [np.interp(part, parts, times) for part in (0.5, 0.75, 1)],
                                                      times[-1] + REST))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("liver", type=pathlib.Path)
    arguments = parser.parse_args()
    print(ROWS, flush=True)
    with tempfile.TemporaryDirectory() as folder:
        for motion in (lambda: press(arguments.liver, pathlib.Path(folder)), lambda: retract(arguments.liver, pathlib.Path(folder)),
                       lambda: bend(pathlib.Path(folder))):
            print(motion(), flush=True)


if __name__ == "__main__":
    main()
