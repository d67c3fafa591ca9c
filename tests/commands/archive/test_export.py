# SPDX-License-Identifier: GPL-3.0-or-later
"""palpate export: what comes back, what goes along, what other programs and a real archive say of it."""
import gzip
import json
import os
import pathlib
import re
import shutil
import struct
import subprocess
import tarfile
import tempfile
import unittest

import orthanc_here  # first: it says where the next one is
from test_import import dicom_slice

BIN = pathlib.Path(os.environ["PALPATE_BIN"])
DATA = pathlib.Path(os.environ["PALPATE_DATA"])
CHEST = DATA / "chest_upperabdomen_dicom_lidc0314" / "dicom_lidc0314_80.tar.gz"
OK, USAGE, INVALID, CONTRACT = 0, 2, 3, 4
C, S = 0.8660254037844387, 0.5


def seg_nrrd(path, size, directions, values, names, origin="(-10.25,20.5,-3.125)"):
    """A label map of uint8; `names` by value with a colour."""
    header = ("NRRD0004\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\nencoding: raw\n"
              f"sizes: {' '.join(map(str, size))}\nspace directions: {directions}\nspace origin: {origin}\n")
    for n, (value, (name, colour)) in enumerate(names.items()):
        header += f"Segment{n}_Name:={name}\nSegment{n}_LabelValue:={value}\nSegment{n}_Layer:=0\nSegment{n}_Color:={colour}\n"
    path.write_bytes(header.encode() + b"\n" + bytes(values))
    return path


def axes(*columns):
    return " ".join("({:.17g},{:.17g},{:.17g})".format(*column) for column in columns)


class Export(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)

    def palpate(self, command, *arguments, code=OK):
        result = subprocess.run([BIN / f"palpate-{command}", *map(str, arguments)], text=True, stdout=subprocess.PIPE,
                                stderr=subprocess.PIPE, timeout=120)
        self.assertEqual(result.returncode, code, result.stderr + result.stdout)
        return result

    def export(self, *arguments, out="out.dcm", code=OK):
        self.palpate("export", *arguments, "-o", self.folder / out, code=code)
        return self.folder / out

    def back(self, dicom):
        """Grid, names and voxels of a label map as our own reader has them."""
        out = self.folder / "back.seg.nrrd"
        result = self.palpate("import", "--labels", dicom, "-o", out, "--force", "--json", "-")
        content = out.read_bytes()
        head, packed = content.split(b"\n\n", 1)
        colours = dict(re.findall(r"Segment(\d+)_Color:=(.*)", head.decode()))
        said = json.loads(result.stdout)
        names = [label["name"] for label in said["labels"]]
        return said["grid"], names, [list(map(float, colours[str(n)].split())) for n in range(len(names))], gzip.decompress(packed)

    def labels(self, size=(5, 7, 6), directions=None):
        """Three labels on an oblique, anisotropic grid, not on every slice; a plane is no whole number of bytes."""
        directions = directions or axes((0.7 * C, 0.7 * S, 0), (-1.3 * S, 1.3 * C, 0), (0, 0, 2.5))
        plane, count = size[0] * size[1], size[0] * size[1] * size[2]
        values = [2 if n // plane == 4 and n % 3 == 0 else 3 if n // plane in (2, 4) and n % 5 == 1 else
                  1 if n // plane == 2 and n % 2 == 0 else 0 for n in range(count)]
        names = {1: ("liver", "0.9 0.2 0.1"), 2: ("kidney_left", "0.1 0.6 0.3"), 3: ("Gef\u00e4\u00df", "0.2 0.3 0.95")}
        return seg_nrrd(self.folder / "in.seg.nrrd", size, directions, values, names), values

    def test_a_label_map_comes_back_as_it_was(self):
        path, values = self.labels()
        grid, names, colours, voxels = self.back(self.export(path))
        self.assertEqual((grid["size"], names), ([5, 7, 6], ["liver", "kidney_left", "Gef\u00e4\u00df"]))
        self.assertEqual(list(voxels), values)
        for found, expected in ((grid["spacing_mm"], (0.7, 1.3, 2.5)), (grid["origin_mm"], (-10.25, 20.5, -3.125)),
                                (grid["direction_columns"], (C, S, 0, -S, C, 0, 0, 0, 1))):
            for a, b in zip(found, expected):
                self.assertAlmostEqual(a, b, delta=1e-9)  # 16 characters hold 12 digits at least
        for found, expected in zip(colours, ((0.9, 0.2, 0.1), (0.1, 0.6, 0.3), (0.2, 0.3, 0.95))):
            for a, b in zip(found, expected):
                self.assertAlmostEqual(a, b, delta=0.002)  # half a step of 8 bits

    def test_axes_that_run_against_each_other_keep_every_voxel_in_place(self):
        path, values = self.labels(directions=axes((0.7, 0, 0), (0, 1.3, 0), (0, 0, -2.5)))
        grid, _, _, voxels = self.back(self.export(path))
        self.assertEqual(grid["origin_mm"], [-10.25, 20.5, -3.125 - 5 * 2.5])
        slices = [values[35 * k:35 * (k + 1)] for k in range(6)]
        self.assertEqual(list(voxels), sum(reversed(slices), []))

    def test_values_with_gaps_are_numbered_anew_in_their_order(self):
        path = seg_nrrd(self.folder / "a.seg.nrrd", (4, 4, 3), axes((1, 0, 0), (0, 1, 0), (0, 0, 1)),
                        [200 if n < 5 else 7 if n > 40 else 0 for n in range(48)],
                        {7: ("liver", "1 0 0"), 200: ("spleen", "0 1 0")})
        _, names, _, voxels = self.back(self.export(path))
        self.assertEqual(names, ["liver", "spleen"])
        self.assertEqual(list(voxels), [2 if n < 5 else 1 if n > 40 else 0 for n in range(48)])

    def test_equal_input_gives_equal_bytes_and_other_input_other_uids(self):
        path, _ = self.labels()
        first = self.export(path, out="a.dcm").read_bytes()
        self.assertEqual(first, self.export(path, out="b.dcm").read_bytes())
        self.labels(directions=axes((0.7, 0, 0), (0, 1.3, 0), (0, 0, 2.5)))
        uids = [set(re.findall(rb"2\.25\.\d+", content)) for content in (first, self.export(path, out="c.dcm").read_bytes())]
        self.assertEqual(len(uids[0]), 5)
        self.assertFalse(uids[0] & uids[1])

    def surface(self):
        """A tetrahedron, as binary STL with a patient in its header."""
        corners = ((0, 0, 0), (10, 0, 0), (0, 12, 0), (0, 0, 14))
        triangles = ((0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3))
        path = self.folder / "roe.stl"
        self.write_stl(path, corners, triangles)
        return path, corners, triangles

    def write_stl(self, path, corners, triangles):
        path.write_bytes(b"ROE^JANE PID-77123".ljust(80) + struct.pack("<I", len(triangles)) +
                         b"".join(struct.pack("<12fH", 0, 0, 0, *(x for v in t for x in corners[v]), 0) for t in triangles))

    def payload(self, dicom):
        content = dicom.read_bytes()
        at = content.index(struct.pack("<HH", 0x42, 0x11) + b"OB")
        return content[at + 12:at + 12 + struct.unpack_from("<I", content, at + 8)[0]]

    def test_an_encapsulated_surface_is_a_closed_binary_stl_of_the_same_triangles(self):
        path, corners, triangles = self.surface()
        dicom = self.export(path, "--title", "kidney left")
        stl = self.payload(dicom)
        self.assertEqual(len(stl), 84 + 50 * 4)
        self.assertNotIn(b"ROE", dicom.read_bytes())
        found = {frozenset(struct.unpack_from("<3f", stl, 84 + 50 * n + 12 + 12 * v) for v in range(3)) for n in range(4)}
        self.assertEqual(found, {frozenset(corners[v] for v in t) for t in triangles})
        (self.folder / "out.stl").write_bytes(stl)
        self.assertEqual(stl, self.payload(self.export(self.folder / "out.stl", "--title", "kidney left", out="again.dcm")))
        self.assertEqual(dicom.read_bytes(), (self.folder / "again.dcm").read_bytes())

    def test_refusals_name_the_culprit(self):
        path, corners, triangles = self.surface()
        self.write_stl(path, corners, triangles[:3])
        empty = seg_nrrd(self.folder / "e.seg.nrrd", (4, 4, 3), axes((1, 0, 0), (0, 1, 0), (0, 0, 1)), [0] * 48, {})
        labels, _ = self.labels()
        (self.folder / "there.dcm").write_bytes(b"x")
        (self.folder / "text").mkdir()
        (self.folder / "text/a.txt").write_text("no DICOM")
        for arguments, phrase, code in (((path,), "open edge", INVALID), ((empty,), "every voxel is background", INVALID),
                                        ((labels, "--reference", self.folder / "text"), "holds no DICOM image series", INVALID),
                                        ((labels, "--identity"), "without --reference", USAGE)):
            said = self.palpate("export", *arguments, "-o", self.folder / "o.dcm", code=code).stderr
            self.assertIn(phrase, said)
            self.assertFalse((self.folder / "o.dcm").exists())
        self.export(labels, out="there.dcm", code=INVALID)
        self.assertEqual((self.folder / "there.dcm").read_bytes(), b"x")
        self.export(labels, "--force", out="there.dcm")

    def series(self):
        """The slices of test_import: 4 x 5 x 6 voxels of 0.5 x 0.5 x 2 mm from (10, 20, 0)."""
        (self.folder / "ct").mkdir()
        for k in range(6):
            content = dicom_slice(k, uid="1.2.826.0.1.99.55.1234567890.1")
            (self.folder / f"ct/{k}.dcm").write_bytes(content)
        return self.folder / "ct"

    def on_series(self, origin="(10,20,0)"):
        return seg_nrrd(self.folder / "s.seg.nrrd", (4, 5, 6), axes((0.5, 0, 0), (0, 0.5, 0), (0, 0, 2)),
                        [1 if 30 <= n < 60 else 0 for n in range(120)], {1: ("liver", "1 0 0")}, origin)

    def test_identity_goes_along_only_where_it_is_asked_for(self):
        reference, labels = self.series(), self.on_series()
        anonymous = self.export(labels, out="a.dcm").read_bytes()
        filed = self.export(labels, "--reference", reference, out="b.dcm").read_bytes()
        named = self.export(labels, "--reference", reference, "--identity", out="c.dcm").read_bytes()
        for identity in (b"ROE^JANE", b"PID-77123", b"19610203"):
            self.assertNotIn(identity, anonymous)
            self.assertNotIn(identity, filed)
            self.assertIn(identity, named)
        for content in (anonymous, filed, named):
            self.assertNotIn(b"Saint Elsewhere", content)
        self.assertNotIn(b"1.2.826", anonymous)
        self.assertIn(b"1.2.826.0.1.99.55.1234567890.1", filed)
        self.assertIn(b"1.2.826.0.1.99.3", filed)  # a slice

    def test_a_reference_of_another_geometry_is_refused_with_the_figures(self):
        reference, labels = self.series(), self.on_series("(10,23,0)")
        said = self.palpate("export", labels, "--reference", reference, "-o", self.folder / "o.dcm", code=INVALID).stderr
        for phrase in ("up to 3 mm off", "(10, 23, 0)", "(10, 20, 0)", "4 x 5 x 6 voxels"):
            self.assertIn(phrase, said)
        turned, _ = self.labels(size=(4, 5, 6))
        said = self.palpate("export", turned, "--reference", reference, "-o", self.folder / "o.dcm", code=INVALID).stderr
        self.assertIn("turned by up to 30 degrees", said)

    def test_a_map_on_mirrored_axes_is_laid_on_the_slices_of_its_reference(self):
        reference = self.series()
        values = [1 if 30 <= n < 60 else 0 for n in range(120)]
        mirrored = [values[20 * k + 4 * j + i] for k in range(6) for j in reversed(range(5)) for i in reversed(range(4))]
        path = seg_nrrd(self.folder / "m.seg.nrrd", (4, 5, 6), axes((-0.5, 0, 0), (0, -0.5, 0), (0, 0, 2)), mirrored,
                        {1: ("liver", "1 0 0")}, "(11.5,22,0)")
        grid, _, _, voxels = self.back(self.export(path, "--reference", reference))
        self.assertEqual((grid["origin_mm"], list(voxels)), ([10, 20, 0], values))

    @unittest.skipUnless(shutil.which("dciodvfy"), "not installed: dicom3tools")
    def test_an_independent_judge_finds_no_error(self):
        reference, labels = self.series(), self.on_series()
        surface, _, _ = self.surface()
        # The reference's own UIDs and units are made up; those that are ours are judged without it.
        for dicom in (self.export(labels, out="a.dcm"), self.export(surface, out="b.dcm"),
                      self.export(labels, "--reference", reference, out="c.dcm")):
            result = subprocess.run(["dciodvfy", str(dicom)], text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
            self.assertNotIn("Error", result.stdout)

    @unittest.skipUnless(shutil.which("dcmdump"), "not installed: dcmtk")
    def test_segments_say_what_they_are(self):
        path, _ = self.labels()
        dump = subprocess.run(["dcmdump", str(self.export(path, "--algorithm", "automatic", "--algorithm-name", "a net"))],
                              text=True, stdout=subprocess.PIPE, check=True).stdout
        for phrase in ("[liver]", "[10200004]", "[kidney_left]", "[64033007]", "[7771000]", "[85756007]", "[AUTOMATIC]", "[a net]",
                       "[ANONYMOUS^PATIENT]", "(0010,0030) DA (no value", "(0008,0020) DA (no value"):
            self.assertIn(phrase, dump)

    @unittest.skipIf(orthanc_here.why_not(), f"no archive can be started: {orthanc_here.why_not()}")
    @unittest.skipUnless(CHEST.exists(), f"no {CHEST}")
    def test_a_real_archive_files_the_results_beside_the_series(self):
        with tarfile.open(CHEST) as archive:
            archive.extractall(self.folder / "ct")
        volume, labels = self.folder / "v.nrrd", self.folder / "l.seg.nrrd"
        self.palpate("import", self.folder / "ct", "-o", volume)
        self.palpate("segment", "--volume", volume, "--structure", "bone: recipe=bone", "-o", labels)
        beside = ("--reference", self.folder / "ct", "--identity")
        segmentation, surface = self.export(labels, *beside), self.export(labels, "--label", "bone", *beside, out="stl.dcm")
        home = self.folder / "orthanc"
        home.mkdir()
        orthanc = orthanc_here.Archive(home)
        orthanc.start()
        self.addCleanup(orthanc.stop)
        slices = sorted(path for path in (self.folder / "ct").rglob("*.dcm"))
        stored = [orthanc.ask("/instances", path.read_bytes()) for path in (*slices, segmentation, surface)]
        self.assertEqual({one["Status"] for one in stored}, {"Success"})
        for level in ("ParentPatient", "ParentStudy"):
            self.assertEqual(len({one[level] for one in stored}), 1)
        self.assertEqual(len({one["ParentSeries"] for one in stored}), 3)
        self.assertEqual(orthanc.ask("/statistics")["CountInstances"], len(slices) + 2)
        kept = [orthanc.request(f"/instances/{one['ID']}/file") for one in stored[-2:]]
        self.assertEqual(kept, [segmentation.read_bytes(), surface.read_bytes()])
        tags = orthanc.ask(f"/instances/{stored[-2]['ID']}/simplified-tags")
        uids = {orthanc.ask(f"/instances/{one['ID']}/simplified-tags")["SOPInstanceUID"] for one in stored[:-2]}
        self.assertEqual({one["ReferencedSOPInstanceUID"] for one in tags["ReferencedSeriesSequence"][0]["ReferencedInstanceSequence"]},
                         uids)
        (self.folder / "kept.dcm").write_bytes(kept[0])
        before = self.palpate("import", "--labels", labels, "-o", self.folder / "b.seg.nrrd", "--json", "-")
        after = self.palpate("import", "--labels", self.folder / "kept.dcm", "-o", self.folder / "k.seg.nrrd", "--json", "-")
        for key in ("grid", "labels"):
            self.assertEqual(json.loads(before.stdout)[key], json.loads(after.stdout)[key])


if __name__ == "__main__":
    unittest.main()
