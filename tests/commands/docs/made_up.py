#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes small files of the kinds that readers have from elsewhere.

    made_up.py organs PHANTOM.seg.nrrd OUTPUT.nii.gz     a label map with TotalSegmentator's values
    made_up.py named PHANTOM.seg.nrrd OUTPUT.nii.gz      the same with its names in the file
    made_up.py mri PHANTOM.nrrd OUTPUT.nii.gz            a head in grey values as MRI has them
    made_up.py bids CT.nrrd PHANTOM.seg.nrrd FOLDER      a BIDS dataset of two subjects
    made_up.py ball X,Y,Z RINGS OUTPUT.stl               an ellipsoid with these semi-axes
    made_up.py bar OUTPUT.msh                            Gmsh's tetrahedra, 10 x 5 x 5 in physical group 1
"""
import array
import itertools
import json
import math
import pathlib
import random
import struct
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
sys.dont_write_bytecode = True
from nifti import nrrd_as_nifti, read_nrrd, write_nifti  # noqa: E402

# Of the phantom's labels liver, tumour, vessels, spine, ribs: what TotalSegmentator v2/total calls them.
VALUES = [0, 5, 5, 52, 31, 0]
NAMES = {5: "liver", 31: "vertebrae_L1", 52: "aorta"}
UINT16 = 512  # NIfTI's number of the type
# The corners of a cube in the order in which its diagonal's six tetrahedra take them (Kuhn).
KUHN = [list(itertools.accumulate([0, *(1 << axis for axis in order)])) for order in itertools.permutations(range(3))]


def organs(source, target, names=None):
    size, lps, voxels, kind = read_nrrd(source)
    labels = array.array("B" if kind == 2 else "H", voxels)
    write_nifti(target, size, lps, array.array("H", (VALUES[label] for label in labels)).tobytes(), UINT16, names)


def mri(source, target):
    """Air and bone are dark, the brain is bright, and there is noise in them."""
    size, lps, voxels, kind = read_nrrd(source)
    noise = random.Random(1)
    greys = ((10 if hu < -500 else 80 if hu > 300 else 500) + noise.randrange(-10, 11) for hu in array.array("f" if kind == 16 else "h", voxels))
    write_nifti(target, size, lps, array.array("H", greys).tobytes(), UINT16)


def bids(volume, labels, folder):
    for subject in ("sub-01", "sub-02"):
        nrrd_as_nifti(volume, folder / subject / "ct" / f"{subject}_ct.nii.gz")
        organs(labels, folder / "derivatives" / "hand" / subject / "anat" / f"{subject}_dseg.nii.gz")
    (folder / "derivatives" / "hand" / "dseg.tsv").write_text("index\tname\n" + "".join(f"{value}\t{name}\n" for value, name in NAMES.items()))
    (folder / "dataset_description.json").write_text(json.dumps({"Name": "Phantoms", "BIDSVersion": "1.9.0"}))


def ball(semi_axes, rings, target):
    """A binary STL of `rings` rings from pole to pole, of twice as many corners each."""
    radii, rings = [float(x) for x in semi_axes.split(",")], int(rings)

    def at(ring, corner):
        polar, around = math.pi * ring / rings, math.pi * (corner % (2 * rings)) / rings
        across = math.sin(polar) if 0 < ring < rings else 0
        return [r * x for r, x in zip(radii, (across * math.cos(around), across * math.sin(around), math.cos(polar)))]

    triangles = []
    for ring, corner in itertools.product(range(rings), range(2 * rings)):
        a, b, c, d = at(ring, corner), at(ring + 1, corner), at(ring + 1, corner + 1), at(ring, corner + 1)
        triangles += [[a, b, c]] if ring < rings - 1 else []
        triangles += [[a, c, d]] if ring > 0 else []
    data = (struct.pack("<12fH", 0, 0, 0, *(x for point in triangle for x in point), 0) for triangle in triangles)
    target.write_bytes(bytes(80) + struct.pack("<I", len(triangles)) + b"".join(data))


def bar(target):
    nodes = list(itertools.product(range(11), range(6), range(6)))
    number = {node: n + 1 for n, node in enumerate(nodes)}
    cells = [[number[tuple(low + (corner >> axis & 1) for axis, low in enumerate(cube))] for corner in corners]
             for cube in itertools.product(range(10), range(5), range(5)) for corners in KUHN]
    lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$Nodes", str(len(nodes)), *(f"{number[p]} {p[0]} {p[1]} {p[2]}" for p in nodes),
             "$EndNodes", "$Elements", str(len(cells)), *(f"{n + 1} 4 2 1 1 {' '.join(map(str, cell))}" for n, cell in enumerate(cells)),
             "$EndElements"]
    target.write_text("\n".join(lines) + "\n")


def main(kind, *arguments):
    files = [pathlib.Path(argument) for argument in arguments]
    if kind == "ball":
        ball(*arguments[:2], files[2])
    elif kind == "named":
        organs(*files, NAMES)
    else:
        {"organs": organs, "mri": mri, "bids": bids, "bar": bar}[kind](*files)


if __name__ == "__main__":
    main(*sys.argv[1:])
