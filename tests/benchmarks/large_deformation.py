#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""How far the linear answer is from a nonlinear one: one block, one mesh, CalculiX for both.

    large_deformation.py [--write]      (needs calculix-ccx; a minute; --write puts the table into README.md)

A block of 50 x 50 x 25 mm of 3 000 jittered linear tetrahedra, E 6.3 kPa, Poisson's ratio 0.45, held at its sides and its bottom; six
nodes in the middle of its top are moved. Truth: geometrically nonlinear, neo-Hookean, of the same initial moduli.
"""
import argparse
import pathlib
import re
import subprocess
import tempfile

import numpy as np

CELLS, EDGE = (10, 10, 5), 5.0  # mm
MODULUS, POISSON = 6.3e-3, 0.45  # N/mm²
JITTER = 0.15  # of an edge
KUHN = ((0, 1, 3, 7), (0, 3, 2, 7), (0, 2, 6, 7), (0, 6, 4, 7), (0, 4, 5, 7), (0, 5, 1, 7))  # of a cell's corners, x fastest
MOTIONS = [*((f"press {depth} mm ({100 * depth / 25:.0f} % of the height), free sideways", (None, None, -depth)) for depth in (1.25, 3, 4.5, 6.25)),
           *((f"pull sideways {way} mm, patch held", (way, 0, 0)) for way in (5, 10)), *((f"lift {way} mm, patch held", (0, 0, way)) for way in (5, 10))]
PAGE = pathlib.Path(__file__).with_name("README.md")


def block():
    nodes = np.array([(x, y, z) for z in range(CELLS[2] + 1) for y in range(CELLS[1] + 1) for x in range(CELLS[0] + 1)], float)
    inside = ((nodes > 0) & (nodes < CELLS)).all(axis=1)
    places = nodes * EDGE
    places[inside] += np.random.default_rng(1).uniform(-JITTER, JITTER, (inside.sum(), 3)) * EDGE
    index = lambda x, y, z: x + (CELLS[0] + 1) * (y + (CELLS[1] + 1) * z)
    corners = [[index(x + (c & 1), y + (c >> 1 & 1), z + (c >> 2)) for c in range(8)]
               for z in range(CELLS[2]) for y in range(CELLS[1]) for x in range(CELLS[0])]
    tetrahedra = np.array([[cell[c] for c in tet] for cell in corners for tet in KUHN])
    held = np.flatnonzero((nodes[:, 2] == 0) | (nodes[:, :2] == 0).any(axis=1) | (nodes[:, :2] == CELLS[:2]).any(axis=1))
    top = np.flatnonzero(nodes[:, 2] == CELLS[2])
    return places, tetrahedra, held, top, np.array([index(x, y, CELLS[2]) for y in (5, 6) for x in (4, 5, 6)])


def solve(folder, body, motion, nonlinear):
    """Displacements of all nodes (mm) and the force on the patch (N) as ccx has them."""
    places, tetrahedra, held, _, patch = body
    shear, bulk = MODULUS / (2 * (1 + POISSON)), MODULUS / (3 * (1 - 2 * POISSON))
    law = f"*HYPERELASTIC, NEO HOOKE\n{shear / 2:.9e},{2 / bulk:.9e}" if nonlinear else f"*ELASTIC\n{MODULUS:.9e},{POISSON}"
    lines = ["*NODE, NSET=ALL", *(f"{n + 1},{x:.9f},{y:.9f},{z:.9f}" for n, (x, y, z) in enumerate(places)), "*ELEMENT, TYPE=C3D4, ELSET=E",
             *(",".join(map(str, [e + 1, *(tet + 1)])) for e, tet in enumerate(tetrahedra)), "*NSET, NSET=PATCH", ",".join(str(n + 1) for n in patch),
             "*MATERIAL, NAME=M", law, "*SOLID SECTION, ELSET=E, MATERIAL=M", "*STEP, NLGEOM, INC=200" if nonlinear else "*STEP", "*STATIC",
             *(["0.1,1.,1e-6,0.25"] if nonlinear else []), "*BOUNDARY", *(f"{n + 1},1,3,0." for n in held),
             *(f"{n + 1},{axis + 1},{axis + 1},{way}" for n in patch for axis, way in enumerate(motion) if way is not None),
             "*NODE PRINT, NSET=ALL, FREQUENCY=1000", "U", "*NODE PRINT, NSET=PATCH, FREQUENCY=1000", "RF", "*END STEP"]
    (folder / "block.inp").write_text("\n".join(lines) + "\n")
    (folder / "block.dat").unlink(missing_ok=True)
    talk = subprocess.run(["ccx", "block"], cwd=folder, capture_output=True, text=True).stdout
    tables = re.split(r"\n (?=displacements|forces)", (folder / "block.dat").read_text())
    rows = {name: np.array([line.split()[1:4] for line in next(t for t in reversed(tables) if t.lstrip().startswith(name)).splitlines()[2:]
                            if len(line.split()) == 4], float) for name in ("displacements", "forces")}
    if "Job finished" not in talk:
        raise SystemExit(f"ccx did not finish:\n{talk[-2000:]}")
    return rows["displacements"], rows["forces"].sum(axis=0)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--write", action="store_true")
    arguments = parser.parse_args()
    body = block()
    lines = ["| motion of the patch | neo-Hookean force, N | linear: force off by | surface off by |", "|---|--:|--:|--:|"]
    print("\n".join(lines), flush=True)
    with tempfile.TemporaryDirectory() as folder:
        for name, motion in MOTIONS:
            (true, force), (linear, guess) = (solve(pathlib.Path(folder), body, motion, nonlinear) for nonlinear in (True, False))
            along = max(range(3), key=lambda axis: abs(motion[axis] or 0))
            off = np.linalg.norm(linear - true, axis=1)[body[3]].max() / np.linalg.norm(true, axis=1)[body[3]].max()
            lines.append(f"| {name} | {abs(force[along]):.3f} | {100 * (guess[along] / force[along] - 1):+.1f} % | {100 * off:.0f} % |")
            print(lines[-1], flush=True)
    if arguments.write:
        PAGE.write_text(re.sub(r"(?<=<!-- table of large_deformation.py -->\n).*?(?=<!-- end of table -->)", "\n".join(lines) + "\n", PAGE.read_text(),
                               flags=re.DOTALL))


if __name__ == "__main__":
    main()
