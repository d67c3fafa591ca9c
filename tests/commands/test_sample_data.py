# SPDX-License-Identifier: Apache-2.0
"""sample_data/unpack.py on tiny packages of the same layout as Debian's, so that no network is needed."""
import gzip
import io
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

UNPACK = pathlib.Path(os.environ["PALPATE_SOURCE"]) / "sample_data" / "unpack.py"


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


if __name__ == "__main__":
    unittest.main()
