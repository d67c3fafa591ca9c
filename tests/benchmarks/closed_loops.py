#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What a hand gets back that goes round on frictionless tissue: the work of a closed loop, of what was stored by pressing.

    closed_loops.py ASSET [--depth MM] [--radius MM] [--places N] [--held] [--edges] [--beside] [--large-deformation]
                                                                                         (PALPATE_BIN has the programs)

At places drawn evenly over the surface, where all of it gives way or, with --held, triangles under the circle have held corners, where
it is no edge (normals within 70 degrees) and nothing stands opposite or beside, an infinitely stiff hand goes straight in, then twice
round a circle in the plane of the surface there, in steps of 0.02 mm. The work of the second round should be nothing. Loops that leave
the tissue are left out. With --edges, places on edges and with something opposite or beside count too; with --beside, only places beside a
rigid body, where the tool is between both for part of the round.
"""
import argparse
import os
import pathlib
import subprocess
import tempfile

import h5py
import numpy as np

PALPATE = pathlib.Path(os.environ.get("PALPATE_BIN", "build/release/bin")) / "palpate"
STEP = 0.02  # mm
HEAD = """| case | circle, mm | tool, mm | deep, mm | loops in contact | work of what was stored: median / 90 % / most | largest step of the largest force: median / most |
|---|--:|--:|--:|--:|--:|--:|"""


def places(asset, count, circle, held, edges, beside_bone=False):
    """Points and inward normals (mm) where the surface around is free and no edge, and the tool's radius."""
    with h5py.File(asset) as file:
        body, radius = file["palpate/bodies/deformable/0"], float(file["palpate/haptics"].attrs["tool_radius"])
        triangles = body["surface_nodes"][...][body["surface_triangles"][...]]
        corners_held = (~np.isin(triangles, body["contact_nodes"][...])).sum(axis=1)
        corners = body["rest_positions"][...][triangles]
        rigid = np.vstack([np.zeros((0, 3)), *(other["vertices"][...] for other in file["palpate/bodies"].get("rigid", {}).values())])
    across, middle = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), corners.mean(axis=1)
    area = np.linalg.norm(across, axis=1)
    outward, found = across / area[:, None], []
    part_held = (0 < corners_held) & (corners_held < 3)
    for t in np.random.default_rng(3).choice(len(area), len(area), replace=False, p=area / area.sum()):
        away = np.linalg.norm(middle - middle[t], axis=1)
        around, under = away < circle + radius, abs(away - circle) < radius / 2
        to_rigid = np.linalg.norm(rigid - middle[t], axis=1)
        beside = to_rigid < 2 * (circle + radius)
        starts = middle[t] + outward[t] * (radius + 2)
        if beside_bone and (not (to_rigid < circle + radius).any() or np.linalg.norm(rigid - starts, axis=1).min() < circle + radius):
            continue
        ahead = middle[t] + outward[t] * np.linspace(2 * radius + 1, 2 * radius + 6, 6)[:, None]
        facing = min(np.linalg.norm(middle - place, axis=1).min() for place in ahead) < radius
        suits = part_held[under].any() if held else not corners_held[around].any()
        open_there = (outward[around] @ outward[t]).min() > 0.3 and (beside_bone or not beside.any()) and not facing
        if suits and (edges or open_there):
            found.append((middle[t], -outward[t]))
            if len(found) == count:
                break
    return found, radius


def logged(path, *names):
    """Columns of a log of palpate touch, one row a tick: `?` in a name stands for x, y and z."""
    with open(path) as log:
        columns = log.readline().strip().split(",")
        wanted = [columns.index(name.replace("?", axis)) for name in names for axis in "xyz"]
        return np.split(np.loadtxt(log, delimiter=",", usecols=wanted), len(names), axis=1)


def path(point, inward, radius, depth, circle):
    """Positions of the hand, one a tick, and where the second round begins."""
    side = np.cross(inward, np.eye(3)[np.argmin(abs(inward))])
    side /= np.linalg.norm(side)
    other, steps = np.cross(inward, side), round(2 * np.pi * circle / STEP)
    start = point - side * circle - inward * radius
    down = [start + inward * way for way in np.arange(-2, depth, STEP)]
    angles = np.arange(2 * steps + 1) * 2 * np.pi / steps
    centre = point + inward * (depth - radius)
    turn = [centre - circle * (np.cos(a) * side + np.sin(a) * other) for a in angles]
    return np.array(down + turn), len(down), len(down) + steps


def loop(asset, folder, options, positions, pressed, second):
    """Work of the second round over the energy stored by pressing, and the largest step of force in it over the largest force."""
    np.savetxt(folder / "hand.txt", positions, "%.6f")
    subprocess.run([PALPATE, "touch", asset, "--script", folder / "hand.txt", "--virtual-clock", "--log", folder / "log.csv", "--quiet", "--force",
                    *options], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    where, force = logged(folder / "log.csv", "device_?_mm", "force_?_n")
    work = -0.5 * ((force[1:] + force[:-1]) * np.diff(where, axis=0)).sum(axis=1)  # by the hand
    size = np.linalg.norm(force, axis=1)[second:]
    if size.min() == 0:
        return None
    return abs(work[second:].sum()) / work[:pressed].sum(), np.linalg.norm(np.diff(force[second:], axis=0), axis=1).max() / size.max()


def two_digits(value):
    return f"{float(f'{value:.2g}'):g}"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("asset", type=pathlib.Path)
    parser.add_argument("--depth", type=float, default=1.5)
    parser.add_argument("--radius", type=float, default=3.0, help="of the circle [mm]")
    parser.add_argument("--places", type=int, default=24)
    parser.add_argument("--held", action="store_true", help="where triangles under the circle are held by some of their corners")
    parser.add_argument("--edges", action="store_true", help="on edges and beside others as well")
    parser.add_argument("--beside", action="store_true", help="beside a rigid body")
    parser.add_argument("--large-deformation", action="store_true", help="of neo-Hookean tissue")
    arguments = parser.parse_args()
    options = ["--large-deformation", "all"] if arguments.large_deformation else []
    chosen, tool = places(arguments.asset, arguments.places, arguments.radius, arguments.held, arguments.edges, arguments.beside)
    with tempfile.TemporaryDirectory() as folder:
        loops = [loop(arguments.asset, pathlib.Path(folder), options, *path(*place, tool, arguments.depth, arguments.radius)) for place in chosen]
    work, step = np.array([result for result in loops if result]).T * 100
    case = arguments.asset.stem + ", part held" * arguments.held + ", edges too" * arguments.edges + ", beside bone" * arguments.beside
    case += ", large deformation" * arguments.large_deformation
    print(HEAD)
    print(f"| {case} | {arguments.radius:g} | {tool:g} | {arguments.depth:g} | {len(work)} of {len(loops)} | "
          f"{' / '.join(map(two_digits, (np.median(work), np.percentile(work, 90), work.max())))} % | "
          f"{' / '.join(map(two_digits, (np.median(step), step.max())))} % |")


if __name__ == "__main__":
    main()
