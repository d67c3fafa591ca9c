#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Presses with large deformation: how far a moving hand's force is from that at rest, and linear tissue's beside it.

    large_presses.py ASSET BODY [--depth 12] [--places 6] [--seed 3] [--bin DIR]     (needs h5py, numpy)

BODY is the asset's first deformable body. Virtual time: all figures are the same on every machine.
"""
import argparse
import csv
import json
import pathlib
import subprocess
import sys
import tempfile

import h5py
import numpy as np

QUARTERS = (0.25, 0.5, 0.75, 1)
SPEED = 50  # mm/s


def places(asset, radius, depth, rng):
    """Random triangles that the tool can reach along their normal and press without meeting bone: their centre and normal."""
    bodies = asset["palpate/bodies"]
    body = bodies["deformable/0"]
    points = body["rest_positions"][...][body["surface_nodes"][...]]
    touchable = np.isin(body["surface_nodes"][...], body["contact_nodes"][...])
    triangles = body["surface_triangles"][...]
    corners = points[triangles]
    centres = corners.mean(axis=1)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    rigid = np.vstack([group["vertices"][...] for group in bodies.get("rigid", {}).values()] or [np.full((1, 3), 1e9)])
    nearest = lambda at, to: np.linalg.norm(at[:, None] - to[None], axis=2).min()
    while True:
        k = rng.integers(len(triangles))
        centre, normal = centres[k], normals[k]
        way = centre + normal * np.linspace(2 * radius + 2, 25, 24)[:, None]
        if (touchable[triangles[k]].all() and nearest(way, centres) > radius + 1 and nearest(way, rigid) > radius + 2
                and nearest((centre - depth * normal)[None], rigid) > radius + 3):
            yield centre, normal


def press(arguments, keys, large):
    """Forces of every tick (N) along rows (s, p)."""
    with tempfile.TemporaryDirectory() as folder:
        script, log = pathlib.Path(folder, "hand.txt"), pathlib.Path(folder, "log.csv")
        script.write_text("".join("%.6f %.9g %.9g %.9g\n" % (t, *p) for t, p in keys))
        subprocess.run([*arguments.touch, "--script", script, "--virtual-clock", "--log", log, "--quiet",
                        *(["--large-deformation", arguments.body] if large else [])], check=True, stdout=subprocess.DEVNULL)
        with log.open() as rows:
            return np.array([[float(row[f"force_{axis}_n"]) for axis in "xyz"] for row in csv.DictReader(rows)])


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("asset")
    parser.add_argument("body")
    parser.add_argument("--depth", type=float, default=12)
    parser.add_argument("--places", type=int, default=6)
    parser.add_argument("--seed", type=int, default=3)
    parser.add_argument("--bin", default=pathlib.Path(__file__).parents[2] / "build/release/bin", type=pathlib.Path)
    arguments = parser.parse_args()
    arguments.touch = [arguments.bin / "palpate-touch", arguments.asset]
    asset = h5py.File(arguments.asset)
    radius = float(asset["palpate/haptics"].attrs["tool_radius"])
    found = places(asset, radius, arguments.depth, np.random.default_rng(arguments.seed))
    worst = dict.fromkeys(("moving", "linear", "held", "step"), 0.0)
    for _ in range(arguments.places):
        centre, normal = next(found)
        at = lambda depth: centre + normal * (radius - depth)
        clear = at(-5)
        slow, marks, time = [(0, clear), (0.3, at(0))], [], 0.3
        for part in QUARTERS:
            slow += [(time + 0.25, at(part * arguments.depth)), (time + 1.05, at(part * arguments.depth))]
            time += 1.05
            marks.append(time - 0.01)
        there = 0.5 + arguments.depth / SPEED
        fast = [(0, clear), (0.5, at(0)), (there, at(arguments.depth)), (there + 1.2, at(arguments.depth)), (there + 1.3, clear)]
        tick = lambda t: round(1000 * t) - 1
        rest, linear = (np.linalg.norm(press(arguments, slow, large)[[tick(t) for t in marks]], axis=1) for large in (True, False))
        moving = press(arguments, fast, True)
        passed = np.linalg.norm(moving[[tick(0.5 + part * arguments.depth / SPEED) for part in QUARTERS]], axis=1)
        end = moving[tick(there + 1.19)]
        steps = np.linalg.norm(np.diff(moving[tick(there) + 2:tick(there + 1.19)], axis=0), axis=1)
        off = {"moving": np.abs(passed / rest - 1).max(), "linear": np.abs(linear / rest - 1).max(),
               "held": np.linalg.norm(moving[tick(there + 0.3)] - end) / np.linalg.norm(end), "step": steps.max() / np.linalg.norm(end)}
        worst = {name: max(worst[name], off[name]) for name in worst}
        print("%.3f N: " % np.linalg.norm(end) + ", ".join("%s %.2f %%" % (name, 100 * value) for name, value in off.items()), file=sys.stderr)
    print(json.dumps({f"{name}_percent": round(100 * value, 2) for name, value in worst.items()}))


if __name__ == "__main__":
    main()
