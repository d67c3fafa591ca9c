#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether a hand that knows forces alone finds a tumour under a real liver's front, and finds none where there is none.

    tests/benchmarks/blind_search/blind_search.py [--draws N] [--seed S] [FOLDER]     (sample_data/unpack.py before it)

Each draw puts the demo's tumour, as large and as far below the capsule as pipelines/cases/liver.toml has it, somewhere else, and builds
the organ twice: with it, and with the liver's own tissue in its place, so that mesh and shape are the same. blind_hand.py searches both.
The place to be found is the point of the capsule below which the tumour was put: its normal runs through the tumour's middle, so that
the trainer's exercise 'find' asks for the same. Prints a row for each search and how many were right, and
leaves all in FOLDER, build/blind_search without it, where a second run builds nothing again.

Without --seed the draws are those that are judged. Seeds 1 and 17 are not: the hand's lengths are from the first, its threshold from both.
"""
import argparse
import json
import os
import subprocess
import tempfile
from pathlib import Path

import h5py
import numpy as np

from blind_hand import EYE, FACING, Hand, Surface, search

SOURCE = Path(__file__).resolve().parents[3]
BIN = Path(os.environ.get("PALPATE_BIN", SOURCE / "build/release/bin"))
CASE = SOURCE / "pipelines/cases/liver.toml"
LABELS = SOURCE / "build/sample_data/liver.seg.nrrd"
RADIUS, BELOW = 15.5, 2.0  # mm, of the case's tumour, and between it and the capsule
NEAR = 10.0  # mm; as near counts as found
SEED = 29  # of the draws that are judged
HEAD = """| draw | stiffer there by, % | said | off, mm | evidence | without a tumour, said | its evidence |
|---|--:|--:|--:|--:|--:|--:|"""


# All but the press and the report.
STAGES = ("import labels", "segment", "mesh liver", "condense liver", "surface kidney", "surface gallbladder", "pack")


def build(out, parts, *sets):
    """The demo's liver with keys of its case file set, unless it lies there. Where parts were made before, only others are."""
    if out.exists():
        return out
    keys = [word for key in (f"input.labels={LABELS}", *sets) for word in ("--set", key)]
    for stage in STAGES:
        subprocess.run([BIN / "palpate-build", CASE, "-o", out, "--parts", parts, "--stage", stage, *keys, "--quiet", "--json", out.with_suffix(".json"), "--force"],
                       check=True)
    return out


def pair(folder, name, centre):
    """An organ with the tumour there, and the same mesh of the liver's tissue throughout."""
    place = "structure.tumour.center_mm=[" + ", ".join(f"{x:.1f}" for x in centre) + "]"
    parts = folder / f"{name}.parts"
    return (build(folder / f"{name}.vtkhdf", parts, place),
            build(folder / f"{name}-none.vtkhdf", parts, place, "deformable.liver.region.tumour.tissue=liver"))


def spread(surface, spacing=1.5):
    """Points all over the surface, no farther than about `spacing` mm apart."""
    a, b, c = surface.corners()
    n = int(np.ceil(max(np.linalg.norm(q - p, axis=1).max() for p, q in ((a, b), (b, c), (c, a))) / spacing))
    weights = [(i / n, j / n) for i in range(n + 1) for j in range(n + 1 - i)]
    return np.concatenate([a + u * (b - a) + v * (c - a) for u, v in weights])


def draw(surface, others, random):
    """A centre for the tumour, and the point of the front below which it lies, drawn evenly by area among those where the tumour fits.

    It fits where the point is seen from the front and faces it within 60 degrees, no rigid body is within 20 mm, and the nearest capsule
    to a ball that is BELOW mm beneath the point is 1 to 3 mm away."""
    normals = surface.normals()
    areas = np.linalg.norm(normals, axis=1)
    front = np.where(normals @ EYE >= FACING * areas, areas, 0)
    capsule = spread(surface)
    while True:
        corners = surface.vertices[surface.triangles[random.choice(len(front), p=front / front.sum())]]
        u, v = random.random(2)
        if u + v > 1:
            u, v = 1 - u, 1 - v
        point = corners[0] + u * (corners[1] - corners[0]) + v * (corners[2] - corners[0])
        seen, normal = surface.under(point[0], point[2]), surface.normal_near(point)
        if np.linalg.norm(seen - point) > 1e-6 or normal @ EYE < FACING:
            continue
        centre = point - normal * (RADIUS + BELOW)
        gap = np.linalg.norm(capsule - centre, axis=1).min() - RADIUS
        if 1 <= gap <= 3 and np.linalg.norm(others - point, axis=1).min() > 20:
            return centre.round(1), point


def rigid_vertices(asset):
    with h5py.File(asset) as file:
        return np.concatenate([body["vertices"][:] for body in file["palpate/bodies/rigid"].values()])


def told(asset):
    """By how many per cent the tools say that it is stiffer where the tumour is felt most."""
    shown = subprocess.run([BIN / "palpate-inspect", asset, "--json", "-"], check=True, capture_output=True, text=True)
    (felt,) = json.loads(shown.stdout)["felt"]
    return felt["contrast_percent"]


def judge(place, with_tumour, none):
    """A row: how far from the truth the hand was, and what it said of the same organ without a tumour."""
    row = {"told_percent": told(with_tumour)}
    for key, asset in (("with", with_tumour), ("none", none)):
        with tempfile.TemporaryDirectory() as scratch:
            answer = search(Hand(BIN / "palpate-touch", asset, Path(scratch)), Surface.seen(asset))
        row[key] = {"found": bool(answer.found), "evidence": round(float(answer.evidence), 1), "contrast": round(float(answer.contrast), 3), "presses": answer.presses,
                    "off_mm": round(float(np.linalg.norm(answer.place - place)), 1)}
    row["right"] = row["with"]["found"] and row["with"]["off_mm"] <= NEAR
    row["right_none"] = not row["none"]["found"]
    return row


def table_row(draw, row):
    """What the hand said of a draw, as README.md has it."""
    said, none = row["with"], row["none"]
    place = "found" if row["right"] else "elsewhere" if said["found"] else "none"
    return (f"| {draw} | {row['told_percent']:.0f} | {place} | {said['off_mm']} | {said['evidence']} | {'none' if row['right_none'] else 'found'} | "
            f"{none['evidence']} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--draws", type=int, default=10)
    parser.add_argument("--seed", type=int, default=SEED)
    parser.add_argument("folder", nargs="?", type=Path, default=SOURCE / "build/blind_search")
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    base = build(options.folder / "demo.vtkhdf", options.folder / "demo.parts")
    surface, others = Surface.seen(base), rigid_vertices(base)
    name = f"seed{options.seed}"
    random = np.random.default_rng(options.seed)
    rows = []
    print(HEAD, flush=True)
    for i in range(options.draws):
        centre, place = draw(surface, others, random)
        rows.append({"centre_mm": centre.tolist(), "place_mm": place.round(1).tolist()} | judge(place, *pair(options.folder, f"{name}-{i}", centre)))
        print(table_row(i + 1, rows[-1]), flush=True)
    print(f"\n| draws of seed {options.seed} | right |\n|---|--:|")
    for what, key in (("tumour found", "right"), ("without a tumour, said none", "right_none")):
        print(f"| {what}, {len(rows)} draws | {sum(row[key] for row in rows)} of {len(rows)} |")
    (options.folder / f"{name}.json").write_text(json.dumps(rows, indent=1))


if __name__ == "__main__":
    main()
