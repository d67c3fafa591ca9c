# SPDX-License-Identifier: Apache-2.0
"""sample_data/unpack.py on tiny packages of the same layout as Debian's, so that no network is needed; tools.py."""
import gzip
import io
import math
import os
import pathlib
import plistlib
import shutil
import struct
import subprocess
import sys
import tarfile
import tempfile
import unittest

SAMPLE_DATA = pathlib.Path(os.environ["PALPATE_SOURCE"]) / "sample_data"
UNPACK = SAMPLE_DATA / "unpack.py"


def add(tar, name, data):
    info = tarfile.TarInfo(name)
    info.size = len(data)
    tar.addfile(info, io.BytesIO(data))


def package(cache, name, path, content):
    root = cache / "root"
    (root / "DEBIAN").mkdir(parents=True)
    (root / "DEBIAN/control").write_text(
        f"Package: {name}\nVersion: 1\nArchitecture: all\nMaintainer: nobody <nobody@example.org>\nDescription: x\n")
    (root / path).parent.mkdir(parents=True)
    (root / path).write_bytes(content)
    subprocess.run(["dpkg-deb", "--root-owner-group", "--build", root, cache / f"{name}_1_all.deb"], check=True,
                   stdout=subprocess.DEVNULL)
    shutil.rmtree(root)


def cranium():
    stream = io.BytesIO()
    with tarfile.open(fileobj=stream, mode="w:gz") as tar:
        about = {"name": "Jane Roe", "spacing": [0.5, 0.75, 1.5],
                 "matrix": {"dtype": "int16", "filename": "matrix.dat", "shape": [2, 3, 4]}}
        add(tar, "tmpabc/main.plist", plistlib.dumps(about))
        add(tar, "tmpabc/matrix.dat", struct.pack("<24h", *range(-1000, -976)))
    return stream.getvalue()


def livers():
    header = ("#INRIMAGE-4#{\nXDIM=3\nYDIM=2\nZDIM=1\nVDIM=1\nTYPE=unsigned fixed\nPIXSIZE=8 bits\nVX=0.5\nVY=0.25\nVZ=2\n"
              ).encode()
    image = header + b"\n" * (256 - 4 - len(header)) + b"##}\n" + bytes([0, 84, 85, 127, 255, 7])
    stream = io.BytesIO()
    with tarfile.open(fileobj=stream, mode="w:gz") as tar:
        add(tar, "data/images/liver.inr.gz", gzip.compress(image))
    return stream.getvalue()


def read(path):
    header, _, voxels = path.read_bytes().partition(b"\n\n")
    return header.decode(), gzip.decompress(voxels)


@unittest.skipUnless(shutil.which("dpkg-deb"), "PALPATE: dpkg-deb is absent")
class Unpack(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.home = pathlib.Path(temporary.name)
        self.cache = self.home / "cache"
        self.cache.mkdir()
        self.out = self.home / "out"
        shutil.copy(UNPACK, self.home)
        package(self.cache, "invesalius-examples", "usr/share/doc/invesalius-examples/examples/Cranium.inv3", cranium())
        package(self.cache, "libcgal-demo", "usr/share/doc/libcgal-dev/data.tar.gz", livers())

    def unpack(self):
        return subprocess.run([sys.executable, self.home / "unpack.py", self.out], text=True, stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, timeout=60)

    def test_head_rows_grow_to_anterior_and_slices_to_superior(self):
        self.assertEqual(self.unpack().returncode, 0)
        header, voxels = read(self.out / "head_ct.nrrd")
        for line in ("type: short", "space: left-posterior-superior", "sizes: 4 3 2",
                     "space directions: (0.5,0.0,0.0) (0.0,-0.75,0.0) (0.0,0.0,1.5)"):
            self.assertIn(line, header)
        self.assertEqual(struct.unpack("<24h", voxels), tuple(range(-1000, -976)))
        self.assertNotIn("Jane", header)

    def test_liver_labels_are_named_and_strays_dropped(self):
        self.assertEqual(self.unpack().returncode, 0)
        header, voxels = read(self.out / "liver.seg.nrrd")
        for line in ("sizes: 3 2 1", "Segment2_Name:=liver", "Segment2_LabelValue:=255", "Segment1_Name:=kidney",
                     "Segment0_Name:=gallbladder", "Segment0_LabelValue:=85"):
            self.assertIn(line, header)
        self.assertEqual(voxels, bytes([0, 0, 85, 127, 255, 0]))

    def test_whole_outputs_are_left_alone_and_cut_ones_made_again(self):
        self.assertEqual(self.unpack().returncode, 0)
        head, liver = self.out / "head_ct.nrrd", self.out / "liver.seg.nrrd"
        whole, before = liver.read_bytes(), head.stat().st_mtime_ns
        liver.write_bytes(whole[:-3])
        self.assertEqual(self.unpack().returncode, 0)
        self.assertEqual(head.stat().st_mtime_ns, before)
        self.assertEqual(liver.read_bytes(), whole)
        self.assertEqual(sorted(os.listdir(self.out)), ["head_ct.nrrd", "liver.seg.nrrd"])

    def test_a_damaged_package_is_told_and_leaves_nothing_behind(self):
        (self.cache / "invesalius-examples_1_all.deb").write_bytes(b"no package")
        result = self.unpack()
        self.assertEqual(result.returncode, 1)
        self.assertIn("unpack.py: ", result.stderr)
        self.assertNotIn("Traceback", result.stderr)
        self.assertEqual(os.listdir(self.out), [])


def triangles(path):
    """Of binary STL: corners, mm."""
    data = path.read_bytes()
    count, = struct.unpack_from("<I", data, 80)
    assert len(data) == 84 + 50 * count
    numbers = [struct.unpack_from("<12f", data, 84 + 50 * n) for n in range(count)]
    return [(row[3:6], row[6:9], row[9:12]) for row in numbers]


def volume(surface):
    return sum(a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0])
               for a, b, c in surface) / 6


class Tools(unittest.TestCase):
    NAMES = ["drill", "endoscope", "forceps", "peg", "probe"]

    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.out = pathlib.Path(temporary.name) / "tools"
        self.write()

    def write(self):
        subprocess.run([sys.executable, SAMPLE_DATA / "tools.py", self.out], check=True, stdout=subprocess.DEVNULL, timeout=60)

    def surface(self, name):
        return triangles(self.out / f"{name}.stl")

    def test_each_is_a_closed_surface_without_needless_corners(self):
        self.assertEqual(sorted(os.listdir(self.out)), [f"{name}.stl" for name in self.NAMES])
        for name in self.NAMES:
            edges = [edge for a, b, c in self.surface(name) for edge in ((a, b), (b, c), (c, a))]
            self.assertEqual(len(set(edges)), len(edges), name)
            self.assertEqual({(b, a) for a, b in edges}, set(edges), name)
            self.assertFalse([edge for edge in edges if edge[0] == edge[1]], name)

    def test_each_faces_outwards_as_its_normals_say(self):
        self.assertAlmostEqual(volume(self.surface("peg")), 4000)
        ball = 4 / 3 * math.pi * 3**3
        self.assertAlmostEqual(volume(self.surface("probe")) / (ball + math.pi * 2**2 * (120 - 3)), 1, delta=0.02)
        for name in self.NAMES:
            self.assertGreater(volume(self.surface(name)), 0, name)
            data = (self.out / f"{name}.stl").read_bytes()
            for n, (a, b, c) in enumerate(self.surface(name)):
                x, y, z = struct.unpack_from("<3f", data, 84 + 50 * n)
                self.assertAlmostEqual(math.hypot(x, y, z), 1, delta=1e-6)
                u, v = [q - p for p, q in zip(a, b)], [q - p for p, q in zip(a, c)]
                along = (x * (u[1] * v[2] - u[2] * v[1]) + y * (u[2] * v[0] - u[0] * v[2]) + z * (u[0] * v[1] - u[1] * v[0]))
                self.assertGreater(along, 0, name)

    def test_the_tip_is_at_the_origin_and_the_shaft_goes_up(self):
        lowest = {"drill": -2, "endoscope": -2 * math.tan(math.radians(30)), "forceps": -1, "peg": 0, "probe": -3}
        highest = {"drill": 70, "endoscope": 150, "forceps": 150, "peg": 40, "probe": 120}
        for name in self.NAMES:
            heights = [corner[2] for triangle in self.surface(name) for corner in triangle]
            self.assertAlmostEqual(min(heights), lowest[name], places=3)
            self.assertAlmostEqual(max(heights), highest[name], places=3)

    def test_the_same_bytes_are_written_again(self):
        before = {name: (self.out / f"{name}.stl").read_bytes() for name in self.NAMES}
        self.write()
        self.assertEqual({name: (self.out / f"{name}.stl").read_bytes() for name in self.NAMES}, before)
        self.assertFalse(list(SAMPLE_DATA.glob("__pycache__")))


if __name__ == "__main__":
    unittest.main()
