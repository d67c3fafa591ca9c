#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Sets palpate mesh beside plain CGAL on the same label image, and gmsh and tetgen on the same surface.

Needs a build (cmake --build --preset release --target meshing_peer palpate-mesh palpate-surface palpate-import), real
volumes in PALPATE_DATA, and Debian's packages gmsh and tetgen; a mesher that is not installed is named on stderr and
left out. Prints a Markdown table; --write puts it into README.md beside this file. About ten minutes on two cores.
"""
import argparse
import gzip
import json
import os
import pathlib
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parent
SIZES = (15_000, 50_000, 500_000)
NEAR, TRIES = 0.1, 5  # calibration: within a tenth of the number asked for
MARKS = ("<!-- table of bench_meshing.py -->\n", "<!-- end of table -->\n")


def labels_of_inr(path, folder):
    """The .inr.gz of CGAL's demo as .nrrd, at the origin."""
    content = gzip.decompress(path.read_bytes())
    header = dict(line.split("=", 1) for line in content[:256].decode().splitlines() if "=" in line)
    directions = " ".join("(" + ",".join(header["V" + a] if a == b else "0" for b in "XYZ") + ")" for a in "XYZ")
    output = folder / "labels.nrrd"
    output.write_bytes(f"NRRD0004\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\nsizes: {header['XDIM']} "
                       f"{header['YDIM']} {header['ZDIM']}\nspace directions: {directions}\nkinds: domain domain domain\n"
                       "encoding: raw\nspace origin: (0,0,0)\n\n".encode() + content[256:])
    return output


CASES = (  # title, file below PALPATE_DATA, label, sizes that its voxels can bear
    ("liver, 1.6 l, voxels 0.62 x 0.62 x 1.33 mm", "cgal_images/liver.inr.gz", "255", SIZES),
    ("liver, 1.1 l, voxels 3 x 3 x 3 mm", "abdomen_ct_totalseg3mm/seg_totalseg.nii.gz", "5", SIZES[:2]),
)


class Failed(Exception):
    pass


def processor_seconds():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def timed(*command, folder):
    """Runs a command; returns its wall and its processor seconds."""
    started, before = time.perf_counter(), processor_seconds()
    try:
        run = subprocess.run([str(word) for word in command], cwd=folder, capture_output=True, text=True, timeout=900)
    except subprocess.TimeoutExpired:
        raise Failed("took more than 900 s") from None
    seconds = (time.perf_counter() - started, processor_seconds() - before)
    if run.returncode != 0:
        lines = (run.stdout + run.stderr).splitlines()
        words = [line for line in lines if re.search(r"error|intersect|palpate-\w+: .*;", line, re.I) and "---" not in line]
        raise Failed((words or lines or [f"exit code {run.returncode}"])[0].strip())
    return seconds


class Bench:
    def __init__(self, build, folder):
        self.bin, self.peer, self.folder = build / "bin", build / "tests" / "meshing_peer", folder
        self.labels = folder / "case.seg.nrrd"

    def judge(self, mesh):
        run = subprocess.run([self.peer, "judge", mesh, self.labels], capture_output=True, text=True)
        if run.returncode != 0:
            raise Failed("its mesh is refused: " + run.stderr.strip().removeprefix("meshing_peer: "))
        return json.loads(run.stdout)

    def surface(self, triangles):
        """The smoothed label surface, decimated, as STL; returns the seconds that took."""
        seconds = timed(self.bin / "palpate-surface", "--labels", self.labels, "--label", "body", "--keep-largest",
                        "--max-triangles", triangles, "--force", "-o", "surface.vtp", folder=self.folder)
        timed(self.peer, "stl", "surface.vtp", "surface.stl", folder=self.folder)
        return seconds

    def palpate(self, size):
        # The size alone decides: the contract would refine what is coarse.
        seconds = timed(self.bin / "palpate-mesh", "--labels", self.labels, "--region", "body", "--cell-size",
                        f"{size:.4f}", "--facet-distance", f"{size / 8:.4f}", "--attempts", 1, "--max-distance", 2.5,
                        "--max-mean-distance", 10, "--max-p95-distance", 10, "--min-dice", 0, "--min-region-dice", 0,
                        "--max-centroid-distance", 10, "--force", "-o", "ours.vtu", folder=self.folder)
        return seconds, self.folder / "ours.vtu"

    def cgal(self, size):
        return timed(self.peer, "cgal", "case.inr", f"{size:.4f}", "cgal.mesh",
                     folder=self.folder), self.folder / "cgal.mesh"

    def gmsh(self, size):
        (self.folder / "body.geo").write_text('Merge "surface.stl";\nSurface Loop(1) = {1};\nVolume(1) = {1};\n')
        return timed("gmsh", "-3", "body.geo", "-clmax", f"{size:.4f}", "-format", "msh2", "-o", "gmsh.msh",
                     folder=self.folder), self.folder / "gmsh.msh"

    def tetgen(self, size):
        # Default quality (radius over edge up to 2), cells up to a regular tetrahedron's volume.
        return timed("tetgen", f"-pqa{size ** 3 / 8.5:.4f}gNEF", "surface.stl",
                     folder=self.folder), self.folder / "surface.1.mesh"


def calibrated(mesher, judge, size, wanted):
    """Meshes until the number of tetrahedra is near the one wanted; returns size, seconds and the judgement."""
    best = None
    for _ in range(TRIES):
        seconds, mesh = mesher(size)
        found = judge(mesh)
        off = abs(found["tetrahedra"] / wanted - 1)
        if best is None or off < best[0]:
            best = (off, size, seconds, found)
        elif off > 0.9 * best[0]:
            break  # the surface alone decides about the number
        if off < NEAR:
            break
        size *= (found["tetrahedra"] / wanted) ** (1 / 3)
    return best[1:]


def row(title, wanted, name, seconds, found):
    return (f"| {title} | {wanted} | {name} | {found['tetrahedra']} | {seconds[0]:.1f} / {seconds[1]:.1f} | {found['min_deg']:.1f} – "
            f"{found['max_deg']:.1f} | {found['volume_percent']:+.2f} | {found['mean']:.2f} / {found['p95']:.2f} / "
            f"{found['max']:.2f} | {found['dice']:.4f} |")


def table(build, data, sizes):
    peers = [name for name in ("gmsh", "tetgen") if shutil.which(name)]
    for name in {"gmsh", "tetgen"} - set(peers):
        print(f"bench_meshing: {name} is not installed and left out; apt-get install {name}", file=sys.stderr)
    rows = ["| case | asked for | mesher | tetrahedra | time, wall / processor, s | dihedral angles, ° | volume error, % | "
            "surface distance mean / 95 % / most, mm | Dice |", "|---|--:|---|--:|--:|--:|--:|--:|--:|"]
    for title, file, label, its_sizes in CASES:
        path = data / file
        if not path.exists():
            print(f"bench_meshing: PALPATE_DATA has no {file}; its case is left out", file=sys.stderr)
            continue
        with tempfile.TemporaryDirectory() as scratch:
            folder = pathlib.Path(scratch)
            labels = labels_of_inr(path, folder) if file.endswith(".inr.gz") else path
            bench = Bench(build, folder)
            subprocess.run([bench.peer, "extract", labels, label, folder], check=True)
            last = {}
            for wanted in (size for size in its_sizes if size in sizes):
                triangles = round(8 * wanted ** (2 / 3))
                surface_seconds = None
                for name in ("palpate", "cgal", *peers):
                    shown = {"palpate": "`palpate mesh`", "cgal": "plain CGAL"}.get(name, name)
                    if name in peers and surface_seconds is None:
                        surface_seconds = bench.surface(triangles)
                    first = last[name][0] * (last[name][1] / wanted) ** (1 / 3) if name in last else \
                        2.1 * (1.6e6 / wanted) ** (1 / 3)
                    try:
                        size, seconds, found = calibrated(getattr(bench, name), bench.judge, first, wanted)
                        if name == "palpate":
                            triangles = found["triangles"]
                        last[name] = (size, found["tetrahedra"])
                        rows.append(row(title, wanted, shown, seconds, found))
                    except Failed as failure:
                        rows.append(f"| {title} | {wanted} | {shown} | – | – | {failure} | | | |".replace(scratch, ""))
                    print(rows[-1], file=sys.stderr, flush=True)
    return "\n".join(rows) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=pathlib.Path, default=HERE.parents[1] / "build" / "release")
    parser.add_argument("--data", type=pathlib.Path, default=os.environ.get("PALPATE_DATA"))
    parser.add_argument("--sizes", type=int, nargs="+", default=SIZES, help=f"some of {SIZES}")
    parser.add_argument("--write", action="store_true", help="put the table into README.md beside this file")
    arguments = parser.parse_args()
    if arguments.data is None or not arguments.data.is_dir():
        parser.error("no real volumes: set PALPATE_DATA or pass --data")
    text = table(arguments.build.resolve(), arguments.data.resolve(), set(arguments.sizes))
    print(text, end="")
    if arguments.write:
        page = HERE / "README.md"
        before, rest = page.read_text().split(MARKS[0])
        page.write_text(before + MARKS[0] + text + MARKS[1] + rest.split(MARKS[1])[1])


if __name__ == "__main__":
    main()
