# SPDX-License-Identifier: GPL-3.0-or-later
"""palpate inspect of everything but assets, and --preview: figures against numpy's, refusals, what pictures show."""
import gzip
import json
import os
import pathlib
import struct
import subprocess
import tempfile
import unittest
import zlib

import h5py
import numpy

from test_asset_commands import write_block, write_tetrahedron_surface

BIN = pathlib.Path(os.environ["PALPATE_BIN"])
OK, USAGE, INVALID, QUALITY = 0, 2, 3, 4

SPACING = (1.0, 2.0, 3.0)
ORIGIN = (-10.0, 20.0, 5.0)
COLOURS = {"organ": (0.2, 0.6, 1.0), "lesion": (1.0, 0.4, 0.0)}


def run(command, *arguments):
    return subprocess.run([BIN / f"palpate-{command}", *map(str, arguments)], text=True, stdout=subprocess.PIPE,
                          stderr=subprocess.PIPE, timeout=200)


def write_nrrd(path, voxels, space="left-posterior-superior", extra=""):
    """Voxels by [k, j, i]."""
    kinds = {"uint8": "uint8", "int16": "int16", "uint16": "uint16"}
    directions = " ".join("({},{},{})".format(*(SPACING[a] if a == b else 0 for b in range(3))) for a in range(3))
    header = (f"NRRD0004\ntype: {kinds[str(voxels.dtype)]}\ndimension: 3\nspace: {space}\n"
              f"sizes: {' '.join(map(str, voxels.shape[::-1]))}\nspace directions: {directions}\n"
              f"kinds: domain domain domain\nendian: little\nencoding: gzip\nspace origin: ({','.join(map(str, ORIGIN))})\n{extra}\n")
    path.write_bytes(header.encode() + gzip.compress(voxels.tobytes(), 1, mtime=0))


def labels():
    """A box of label 3 with another one apart from it, and label 7 up to the image's last slice."""
    voxels = numpy.zeros((12, 20, 30), numpy.uint8)
    voxels[3:8, 4:14, 5:15] = 3
    voxels[3:5, 4:7, 20:24] = 3
    voxels[8:12, 6:12, 6:16] = 7
    return voxels


def segments():
    return "".join(f"Segment{n}_Name:={name}\nSegment{n}_LabelValue:={value}\nSegment{n}_Layer:=0\n"
                   f"Segment{n}_Color:={' '.join(map(str, COLOURS[name]))}\n"
                   for n, (name, value) in enumerate((("organ", 3), ("lesion", 7))))


def pixels(path):
    """An 8-bit RGB PNG, rows by columns by 3."""
    data, at, packed = path.read_bytes(), 8, b""
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + length]
        if kind == b"IHDR":
            width, height, depth, colour = struct.unpack(">IIBB", body[:10])
            assert (depth, colour) == (8, 2)
        packed += body if kind == b"IDAT" else b""
        at += length + 12
    raw, across = zlib.decompress(packed), 3 * width
    rows, above = [], bytes(across + 3)  # each after a pixel of zeros
    for y in range(height):
        kind, *line = raw[y * (across + 1):(y + 1) * (across + 1)]
        row = [0, 0, 0]
        for x, value in enumerate(line):
            left, up, corner = row[x], above[x + 3], above[x]
            if kind == 4:
                a, b, c = abs(up - corner), abs(left - corner), abs(left + up - 2 * corner)
                guess = left if a <= b and a <= c else up if b <= c else corner
            else:
                guess = (0, left, up, (left + up) // 2)[kind]
            row.append((value + guess) % 256)
        rows.append(row[3:])
        above = row
    return numpy.array(rows).reshape(height, width, 3)


class InspectCommand(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def inspect(self, path, form, *arguments):
        made = run("inspect", path, "--json", "-", *arguments)
        self.assertEqual(made.returncode, OK, made.stderr)
        result = json.loads(made.stdout)
        self.assertEqual(result["schema"], f"palpate.inspect.{form}/1")
        return result

    def label_map(self):
        path = self.folder / "labels.seg.nrrd"
        write_nrrd(path, labels(), extra=segments())
        return path

    def shows(self, picture, colour):
        wanted = numpy.round(255 * numpy.array(colour)).astype(int)
        return int((abs(picture - wanted).max(axis=2) <= 1).sum())


class Images(InspectCommand):
    def test_a_volume_is_what_numpy_says(self):
        values = numpy.random.default_rng(4).integers(-1000, 1500, (12, 20, 30)).astype(numpy.int16)
        write_nrrd(self.folder / "ct.nrrd", values)
        result = self.inspect(self.folder / "ct.nrrd", "volume")
        grid, found = result["grid"], result["values"]
        self.assertEqual((grid["size"], grid["spacing_mm"], grid["orientation"]), ([30, 20, 12], list(SPACING), "LPS"))
        self.assertEqual((grid["extent_mm"], grid["origin_mm"]), ([30, 40, 36], list(ORIGIN)))
        self.assertEqual((found["min"], found["max"], found["stored_type"], found["unit"]),
                         (values.min(), values.max(), "int16", "HU"))
        for percent in (1, 5, 25, 50, 75, 95, 99):
            self.assertEqual(found[f"p{percent}"], numpy.percentile(values, percent, method="lower"))
        self.assertEqual(result["notes"], [])

    def test_what_lies_in_ras_is_told_and_placed_in_lps(self):
        values = numpy.random.default_rng(5).integers(0, 250, (12, 20, 30)).astype(numpy.uint8)
        write_nrrd(self.folder / "mr.nrrd", values, space="right-anterior-superior")
        result = self.inspect(self.folder / "mr.nrrd", "volume")
        self.assertEqual(result["grid"]["orientation"], "RAS")
        self.assertEqual(result["grid"]["origin_mm"], [10, -20, 5])
        self.assertEqual(result["values"]["unit"], "")

    def test_a_frame_that_was_assumed_is_noted(self):
        values = numpy.random.default_rng(6).integers(0, 250, (12, 20, 30)).astype(numpy.uint8)
        write_nrrd(self.folder / "mr.nrrd", values, space="scanner-xyz")
        self.assertIn("no patient space", self.inspect(self.folder / "mr.nrrd", "volume")["notes"][0])

    def test_labels_are_what_numpy_says(self):
        voxels, result = labels(), self.inspect(self.label_map(), "labels")
        self.assertEqual([label["name"] for label in result["labels"]], ["organ", "lesion"])
        for label, pieces, edge in zip(result["labels"], (2, 1), (False, True)):
            at = numpy.argwhere(voxels == label["value"])[:, ::-1] * SPACING + ORIGIN
            self.assertEqual(label["voxels"], len(at))
            self.assertAlmostEqual(label["volume_ml"], len(at) * numpy.prod(SPACING) / 1000)
            numpy.testing.assert_allclose(label["box_min_mm"], at.min(axis=0))
            numpy.testing.assert_allclose(label["box_max_mm"], at.max(axis=0))
            numpy.testing.assert_allclose(label["centroid_mm"], at.mean(axis=0))
            self.assertEqual((label["components"], label["at_image_edge"]), (pieces, edge))

    def test_labels_without_names_are_found_and_can_be_denied(self):
        write_nrrd(self.folder / "plain.nrrd", labels())
        found = self.inspect(self.folder / "plain.nrrd", "labels")
        self.assertEqual([label["name"] for label in found["labels"]], ["label_3", "label_7"])
        self.assertEqual(self.inspect(self.folder / "plain.nrrd", "volume", "--as", "volume")["values"]["max"], 7)

    def test_people_get_an_aligned_table(self):
        shown = run("inspect", self.label_map()).stdout.splitlines()
        table = [line for line in shown if line.startswith(("label ", "organ", "lesion"))][-3:]
        self.assertEqual(len({len(line) for line in table}), 1, shown)
        self.assertIn("touches", table[2])


class Shapes(InspectCommand):
    def test_a_mesh_is_what_its_points_say(self):
        write_block(self.folder / "block.vtu", n=2, edge=10.0)
        result = self.inspect(self.folder / "block.vtu", "mesh")
        self.assertEqual((result["nodes"], result["tetrahedra"], result["cells"]), (27, 40, {"tetrahedron": 40}))
        self.assertEqual(result["boundary_triangles"], 6 * 4 * 2)
        self.assertAlmostEqual(result["regions"][0]["volume_ml"], 8.0)
        self.assertEqual(result["box"], {"min_mm": [0, 0, 0], "max_mm": [20, 20, 20]})
        self.assertAlmostEqual(result["edges_mm"]["shortest"], 10)
        self.assertAlmostEqual(result["edges_mm"]["longest"], 200 ** 0.5)
        # A corner tetrahedron of a cube has right angles and acos(1 / sqrt 3), the inner regular one acos(1 / 3).
        self.assertAlmostEqual(result["min_dihedral_deg"], numpy.degrees(numpy.arccos(3 ** -0.5)))
        self.assertAlmostEqual(result["max_dihedral_deg"], 90)
        self.assertEqual((result["components"], result["boundary"]["closed"], result["boundary"]["manifold"]), (1, True, True))

    def test_an_open_surface_is_described_not_refused(self):
        path = self.folder / "open.ply"
        path.write_text("ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
                        "element face 3\nproperty list uchar int vertex_indices\nend_header\n"
                        "0 0 0\n30 0 0\n0 40 0\n0 0 50\n3 0 2 1\n3 0 1 3\n3 0 3 2\n")
        result = self.inspect(path, "surface")
        self.assertEqual((result["triangles"], result["boundary"]["closed"], result["boundary"]["open_edges"]), (3, False, 3))
        self.assertAlmostEqual(result["area_mm2"], (30 * 40 + 30 * 50 + 40 * 50) / 2)

    def test_an_unlikely_unit_is_doubted(self):
        write_block(self.folder / "block.vtu", n=2, edge=3.0)
        self.assertIn("is the file in cm?", " ".join(self.inspect(self.folder / "block.vtu", "mesh")["notes"]))


class Parts(InspectCommand):
    def test_digests_tie_parts_to_what_they_were_made_of(self):
        mesh, body, tree = (self.folder / name for name in ("wall.vtu", "wall.body.h5", "wall.obb.h5"))
        write_block(mesh)
        for command in (("condense", mesh, "--material", "1:5,0.45", "--fixed", "plane:0,0,1,0,0,-1", "-o", body),
                        ("obb", mesh, "-o", tree)):
            made = run(*command)
            self.assertEqual(made.returncode, OK, made.stderr)
        of_mesh, of_body, of_tree = (self.inspect(mesh, "mesh"), self.inspect(body, "body"), self.inspect(tree, "obb_tree"))
        self.assertEqual({of_mesh["surface_sha256"], of_body["surface_sha256"], of_tree["surface_sha256"]},
                         {of_tree["surface_sha256"]})
        with h5py.File(tree) as file:
            self.assertEqual(of_tree["boxes"], len(file["palpate/obb_tree/first"]))
            self.assertEqual(of_tree["leaves"], int((file["palpate/obb_tree/count"][:] > 0).sum()))
            self.assertEqual(of_tree["triangles"], len(file["palpate/obb_tree/triangle_order"]))
        with h5py.File(body) as file:
            self.assertEqual(of_body["body"]["nodes"], len(file["palpate/body/rest_positions"]))
            self.assertEqual(of_body["body"]["fixed_nodes"], len(file["palpate/body/fixed_nodes"]))
            self.assertIn(of_body["mechanics_sha256"], str(file["palpate/body/compliance"].attrs["mechanics_sha256"]))
        self.assertAlmostEqual(sum(region["volume_ml"] for region in of_body["regions"]), 27.0)

    def test_a_surface_and_its_tree_have_one_digest(self):
        surface, tree = self.folder / "skull.vtp", self.folder / "skull.obb.h5"
        write_tetrahedron_surface(surface, 0)
        self.assertEqual(run("obb", surface, "-o", tree).returncode, OK)
        self.assertEqual(self.inspect(surface, "surface")["surface_sha256"], self.inspect(tree, "obb_tree")["surface_sha256"])


class Refusals(InspectCommand):
    def refused(self, code, path, *phrases, more=()):
        made = run("inspect", path, *more)
        self.assertEqual(made.returncode, code, made.stderr)
        for phrase in phrases:
            self.assertIn(phrase, made.stderr)

    def test_what_nothing_reads_is_refused_with_what_can_be_read(self):
        path = self.folder / "notes.txt"
        path.write_text("no image")
        self.refused(INVALID, path, "notes.txt", "NRRD", ".vtu", ".body.h5", ".vtkhdf")
        self.refused(INVALID, self.folder / "absent.nrrd", "no such file")
        self.refused(INVALID, self.folder, "holds no DICOM")

    def test_damaged_files_are_refused(self):
        path = self.label_map()
        path.write_bytes(path.read_bytes()[:-30])
        self.refused(INVALID, path, "labels.seg.nrrd")
        broken = self.folder / "broken.obb.h5"
        broken.write_bytes(b"\x89HDF\r\n\x1a\n" + bytes(500))
        self.refused(INVALID, broken, "broken.obb.h5")
        with h5py.File(self.folder / "other.h5", "w") as file:
            file["x"] = 1
        self.refused(INVALID, self.folder / "other.h5", "other.h5")

    def test_misuse_of_as_is_told(self):
        self.refused(USAGE, self.label_map(), "{volume,labels}", more=("--as", "mesh"))
        write_block(self.folder / "block.vtu")
        self.refused(USAGE, self.folder / "block.vtu", "--as", more=("--as", "labels"))


class Preview(InspectCommand):
    def test_a_segmentation_shows_every_label_in_its_colour(self):
        picture = self.folder / "labels.png"
        made = run("segment", "--labels", self.label_map(), "--structure", "organ: recipe=import", "--structure",
                   "lesion: recipe=import", "-o", self.folder / "out.seg.nrrd", "--preview", picture)
        self.assertEqual(made.returncode, OK, made.stderr)
        self.assertIn(str(picture), made.stderr)
        out = (self.folder / "out.seg.nrrd").read_bytes()[:4000].decode(errors="replace")
        colours = [tuple(map(float, line.split(":=")[1].split())) for line in out.splitlines() if "_Color:=" in line]
        self.assertEqual(len(colours), 2)
        shown = pixels(picture)
        for colour in colours:  # outlines in several slices, and more than the legend's 15 x 15 square
            self.assertGreater(self.shows(shown, colour), 600)

    def test_an_existing_picture_is_kept_without_force(self):
        picture = self.folder / "labels.png"
        picture.write_text("mine")
        made = run("segment", "--labels", self.label_map(), "--structure", "organ: recipe=import", "-o",
                   self.folder / "out.seg.nrrd", "--preview", picture)
        self.assertEqual(made.returncode, INVALID, made.stderr)
        self.assertEqual(picture.read_text(), "mine")
        self.assertFalse((self.folder / "out.seg.nrrd").exists())

    def test_a_mesh_is_shown_also_where_it_misses_its_contract(self):
        request = ("mesh", "--labels", self.label_map(), "--region", "organ", "--region", "lesion", "--cell-size", 8,
                   "--allow-components", "--attempts", 1)
        for name, more, code in (("kept", ("--min-dice", 0, "--min-region-dice", 0, "--max-volume-error-percent", 99,
                                           "--max-mean-distance", 9, "--max-p95-distance", 9, "--max-distance", 9,
                                           "--max-centroid-distance", 9), OK),
                                 ("missed", ("--max-mean-distance", 0.0001), QUALITY)):
            mesh, picture = self.folder / f"{name}.vtu", self.folder / f"{name}.png"
            made = run(*request, *more, "-o", mesh, "--preview", picture)
            self.assertEqual(made.returncode, code, made.stderr)
            self.assertEqual(mesh.exists(), code == OK)
            self.assertIn(str(picture), made.stderr.splitlines()[-1])
            shown = pixels(picture)
            for colour in COLOURS.values():
                self.assertGreater(self.shows(shown, colour), 200)  # the legend's square at least
            self.assertGreater(len(numpy.unique(shown.reshape(-1, 3), axis=0)), 50)


if __name__ == "__main__":
    unittest.main()
