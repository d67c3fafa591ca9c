#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The stiffness that an asset stores at its surface beside what `palpate touch` renders there.

    felt_against_touch.py ASSET ... [--places N]      (PALPATE_BIN has the programs)

At vertices taken evenly by their number among those that can be pressed, a hand presses along the inward normal until the tool is as deep
as the asset's stiffness is of; the stored stiffness over the force by that depth.
"""
import argparse
import os
import pathlib
import subprocess
import tempfile

import h5py
import numpy as np

PALPATE = pathlib.Path(os.environ.get("PALPATE_BIN", "build/release/bin")) / "palpate"


def ratio(asset, folder, place, inward, radius, depth, stored):
    """Stored over rendered stiffness; None where the tool does not come that deep, as beside a bone, or is not felt."""
    ways = np.arange(-2, 3 * depth + 5 * stored, 0.02)
    np.savetxt(folder / "hand.txt", place + inward * (ways[:, None] - radius), "%.6f")
    subprocess.run([PALPATE, "touch", asset, "--script", folder / "hand.txt", "--virtual-clock", "--log", folder / "log.csv", "--quiet", "--force"],
                   check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    rows = np.genfromtxt(folder / "log.csv", delimiter=",", names=True, usecols=range(10))
    tool = np.stack([rows[f"tool_{axis}_mm"] for axis in "xyz"], axis=1)
    force = np.linalg.norm([rows[f"force_{axis}_n"] for axis in "xyz"], axis=0)
    sunk = (tool - place) @ inward + radius
    deep = np.flatnonzero((sunk >= depth) & (force > 0))
    return stored * sunk[deep[0]] / force[deep[0]] if len(deep) else None


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("assets", nargs="+", type=pathlib.Path)
    parser.add_argument("--places", type=int, default=36)
    arguments = parser.parse_args()
    print("| case | places | median | within 10 % | within 20 % |\n|---|--:|--:|--:|--:|", flush=True)
    for asset in arguments.assets:
        with h5py.File(asset) as file:
            body, radius = file["palpate/bodies/deformable/0"], float(file["palpate/haptics"].attrs["tool_radius"])
            depth, stiffness = float(body["feel"].attrs["depth"]), body["feel/stiffness"][...]
            points, triangles = body["rest_positions"][...][body["surface_nodes"][...]], body["surface_triangles"][...]
        normals = np.zeros_like(points)
        for corner in range(3):
            np.add.at(normals, triangles[:, corner], np.cross(points[triangles[:, 1]] - points[triangles[:, 0]], points[triangles[:, 2]] - points[triangles[:, 0]]))
        normals /= np.linalg.norm(normals, axis=1)[:, None]
        pressed = np.flatnonzero(stiffness > 0)
        chosen = pressed[np.linspace(0, len(pressed) - 1, arguments.places).astype(int)]
        with tempfile.TemporaryDirectory() as folder:
            found = [ratio(asset, pathlib.Path(folder), points[v], -normals[v], radius, depth, float(stiffness[v])) for v in chosen]
        ratios = np.array([value for value in found if value])
        within = [(abs(ratios - 1) < part).sum() for part in (0.1, 0.2)]
        print(f"| {asset.stem} | {len(ratios)} | {np.median(ratios):.2f} | " + " | ".join(f"{count} of {len(ratios)}" for count in within) + " |", flush=True)


if __name__ == "__main__":
    main()
