# SPDX-License-Identifier: GPL-3.0-or-later
"""palpate pack, inspect, verify: a small body from mesh to asset, and what they say of bad input."""
import json
import os
import pathlib
import re
import resource
import signal
import subprocess
import sys
import tempfile
import unittest

import h5py
import numpy

BIN = pathlib.Path(os.environ["PALPATE_BIN"])
SOURCE = pathlib.Path(os.environ["PALPATE_SOURCE"])
SAMPLE = pathlib.Path(os.environ["PALPATE_BUILD"]) / "tests" / "write_sample_case"

OK, FAILED, USAGE, INVALID, QUALITY = 0, 1, 2, 3, 4


def run(program, *arguments, **options):
    return subprocess.run([program, *map(str, arguments)], text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          timeout=120, **options)


def array(name, kind, values, components=1):
    flat = " ".join(str(value) for value in numpy.asarray(values).ravel())
    return f'<DataArray type="{kind}" Name="{name}" NumberOfComponents="{components}" format="ascii">{flat}</DataArray>'


def grid(kind, points, section, cells, types="", data=""):
    counts = f'NumberOfPoints="{len(points)}" ' + (
        f'NumberOfCells="{len(cells)}"' if kind == "UnstructuredGrid" else
        f'NumberOfVerts="0" NumberOfLines="0" NumberOfStrips="0" NumberOfPolys="{len(cells)}"')
    offsets = [len(cells[0]) * (i + 1) for i in range(len(cells))]
    return (f'<VTKFile type="{kind}" version="1.0" byte_order="LittleEndian" header_type="UInt64"><{kind}><Piece {counts}>'
            f'<CellData>{data}</CellData><Points>{array("Points", "Float64", points, 3)}</Points>'
            f'<{section}>{array("connectivity", "Int64", cells)}{array("offsets", "Int64", offsets)}{types}</{section}>'
            f'</Piece></{kind}></VTKFile>')


def write_block(path, n=3, edge=10.0):
    """n x n x n cubes of five tetrahedra each, mirrored from cube to cube so that faces match."""
    node = lambda i, j, k: i + (n + 1) * (j + (n + 1) * k)
    points = [(i * edge, j * edge, k * edge) for k in range(n + 1) for j in range(n + 1) for i in range(n + 1)]
    tetrahedra = []
    for k in range(n):
        for j in range(n):
            for i in range(n):
                c = [node(i + (b & 1), j + (b >> 1 & 1), k + (b >> 2)) for b in range(8)]
                for tet in ([(0, 1, 2, 4), (3, 2, 1, 7), (5, 4, 7, 1), (6, 7, 4, 2), (1, 2, 4, 7)] if (i + j + k) % 2 == 0 else
                            [(1, 0, 3, 5), (2, 3, 0, 6), (4, 5, 6, 0), (7, 6, 5, 3), (0, 3, 5, 6)]):
                    p = numpy.array([points[c[v]] for v in tet])
                    order = tet if numpy.linalg.det(p[1:] - p[0]) > 0 else (tet[1], tet[0], tet[2], tet[3])
                    tetrahedra.append([c[v] for v in order])
    types = array("types", "UInt8", [10] * len(tetrahedra))
    path.write_text(grid("UnstructuredGrid", points, "Cells", tetrahedra, types, array("region", "Int32", [1] * len(tetrahedra))))


def write_tetrahedron_surface(path, x):
    points = [(x, 0, 0), (x + 9, 0, 0), (x, 9, 0), (x, 0, 9)]
    path.write_text(grid("PolyData", points, "Polys", [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]))


def write_volume(path, origin=(-19.2, -49.6, -40.0), spacing=(2.0, 2.0, 5.0), size=(60, 50, 30)):
    """A volume turned about z whose value is 10 x + 4 y - 6 z - 300, in HU; returns its columns of direction."""
    turn = numpy.deg2rad(20)
    direction = numpy.array([[numpy.cos(turn), -numpy.sin(turn), 0], [numpy.sin(turn), numpy.cos(turn), 0], [0, 0, 1]])
    k, j, i = numpy.indices(size[::-1])
    place = numpy.array(origin) + numpy.stack([i, j, k], -1) * spacing @ direction.T
    values = numpy.rint(place @ (10, 4, -6) - 300).astype("<i2")
    steps = " ".join("({:.17g},{:.17g},{:.17g})".format(*direction[:, a] * spacing[a]) for a in range(3))
    path.write_bytes((f"NRRD0004\ntype: int16\ndimension: 3\nspace: left-posterior-superior\nsizes: {' '.join(map(str, size))}\n"
                      f"space directions: {steps}\nkinds: domain domain domain\nendian: little\nencoding: raw\n"
                      f"space origin: ({','.join(map(str, origin))})\n\n").encode() + values.tobytes())
    return direction


class AssetCommand(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.inputs = tempfile.TemporaryDirectory()
        cls.parts = pathlib.Path(cls.inputs.name)
        write_block(cls.parts / "wall.vtu")
        write_tetrahedron_surface(cls.parts / "skull.vtp", 40)
        for command in ([BIN / "palpate-condense", cls.parts / "wall.vtu", "--material", "1:5,0.45", "--fixed",
                         "plane:0,0,1,0,0,-1", "-o", cls.parts / "wall.body.h5"],
                        [BIN / "palpate-obb", cls.parts / "wall.vtu", "-o", cls.parts / "wall.obb.h5"],
                        [BIN / "palpate-obb", cls.parts / "skull.vtp", "-o", cls.parts / "skull.obb.h5"]):
            made = run(*command)
            assert made.returncode == OK, made.stderr

    @classmethod
    def tearDownClass(cls):
        cls.inputs.cleanup()

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.asset = self.folder / "case.vtkhdf"

    def pack(self, *extra, output=None, **options):
        return run(BIN / "palpate-pack", "--name", "case", "--rigid",
                   f"skull={self.parts / 'skull.vtp'},{self.parts / 'skull.obb.h5'}", "--deformable",
                   f"wall={self.parts / 'wall.body.h5'},{self.parts / 'wall.obb.h5'}", "-o", output or self.asset, *extra,
                   **options)

    def sample(self):
        made = run(SAMPLE, self.asset)
        self.assertEqual(made.returncode, OK, made.stderr)
        return self.asset

    def assertFails(self, result, code, *messages):
        self.assertEqual(result.returncode, code, result.stderr)
        for message in messages:
            self.assertIn(message, result.stderr)

    def assertNothingLeft(self):
        self.assertEqual([p.name for p in self.folder.iterdir() if p.name not in ("given.json", "other.obb.h5")], [])


class Pack(AssetCommand):
    def test_what_is_packed_verifies(self):
        self.assertEqual(self.pack().returncode, OK)
        verified = run(BIN / "palpate-verify", self.asset, "--json", "-")
        self.assertEqual(verified.returncode, OK, verified.stderr)
        result = json.loads(verified.stdout)
        self.assertEqual(result["verdict"], "ok")
        figures = {row["check"]: row["figure"] for row in result["checks"] if row["of"] == "wall"}
        self.assertLess(figures["residual of 16 re-solved columns"], 1e-6)
        self.assertEqual({row["status"] for row in result["checks"]}, {"ok"})

    def test_a_rigid_surface_that_verify_would_not_take_is_not_packed(self):
        points = [(0, 0, 0), (9, 0, 0), (0, 9, 0), (0, 0, 9)]
        sides = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]
        for wrong, triangles in (("3 open edges", sides[:3]), ("4 triangles turned: their piece faced inwards", [side[::-1] for side in sides]),
                                 ("1 triangles turned to the side of their neighbours", [sides[0][::-1], *sides[1:]])):
            (self.folder / "given.vtp").write_text(grid("PolyData", points, "Polys", triangles))
            refused = run(BIN / "palpate-pack", "--name", "case", "--rigid", f"skull={self.folder / 'given.vtp'}", "-o", self.asset)
            self.assertFails(refused, INVALID, "given.vtp", wrong)
            (self.folder / "given.vtp").unlink()
            self.assertNothingLeft()

    def test_a_tool_of_another_radius_is_pressed_anew_without_condensing(self):
        feel = {}
        for radius in (1, 4):
            made = self.pack("--tool-radius", radius, "--json", "-", "--force")
            self.assertEqual(made.returncode, OK, made.stderr)
            packed = json.loads(made.stdout)
            seen = json.loads(run(BIN / "palpate-inspect", self.asset, "--json", "-").stdout)
            wall = next(body for body in seen["bodies"] if body["name"] == "wall")
            for figure in ("least_n_per_mm", "median_n_per_mm", "largest_n_per_mm"):
                self.assertEqual(wall[figure], packed["feel"][0][figure])
            self.assertEqual((packed["felt"], packed["warnings"]), ([], []), "the body has one region")
            feel[radius] = packed["feel"][0]
            self.assertEqual(feel[radius]["tool_radius_mm"], radius)
        self.assertGreater(feel[4]["median_n_per_mm"], feel[1]["median_n_per_mm"])

    def test_equal_parts_give_equal_bytes_whatever_was_in_memory(self):
        for name, fill in (("a", "85"), ("b", "170")):
            made = self.pack(output=self.folder / name, env={**os.environ, "MALLOC_PERTURB_": fill})
            self.assertEqual(made.returncode, OK, made.stderr)
        self.assertEqual((self.folder / "a").read_bytes(), (self.folder / "b").read_bytes())

    def test_settings_and_provenance_arrive(self):
        given = self.folder / "given.json"
        given.write_text('{"inputs": {"volume_sha256": "abc"}, "steps": ["mesh --labels head.seg.nrrd"]}')
        made = self.pack("--tool-radius", 2, "--coupling-stiffness", 0.3, "--max-force", 2.5, "--max-force-rate", 0.1,
                         "--friction-at-rest", 0.4, "--friction-sliding", 0.2, "--shaft-length", 30, "--grip", 0.01,
                         "--provenance", given)
        self.assertEqual(made.returncode, OK, made.stderr)
        seen = json.loads(run(BIN / "palpate-inspect", self.asset, "--json", "-").stdout)
        self.assertEqual(seen["haptics"], {"tool_radius_mm": 2.0, "coupling_stiffness_n_per_mm": 0.3, "max_force_n": 2.5,
                                           "max_force_rate_n_per_ms": 0.1, "friction_at_rest": 0.4,
                                           "friction_sliding": 0.2, "shaft_length_mm": 30.0, "grip_kpa": 10.0})
        self.assertEqual(seen["provenance"]["build"]["inputs"]["volume_sha256"], "abc")
        self.assertIn("HDF5", seen["provenance"]["software"]["libraries"])

    def test_the_scan_is_cut_to_the_bodies_and_lies_where_the_volume_does(self):
        direction = write_volume(self.parts / "volume.nrrd")
        made = self.pack("--scan", self.parts / "volume.nrrd", "--json", "-")
        self.assertEqual(made.returncode, OK, made.stderr)
        seen = json.loads(run(BIN / "palpate-inspect", self.asset, "--json", "-").stdout)
        self.assertEqual(seen["scan"], json.loads(made.stdout)["scan"])
        self.assertEqual(seen["scan"]["values"], "HU")
        numpy.testing.assert_allclose(seen["scan"]["spacing_mm"], (2, 2, 5), rtol=1e-12)
        with h5py.File(self.asset) as file:
            scan = file["palpate/scan"]
            voxels, origin = scan["voxels"][...], scan["origin"][...]
            numpy.testing.assert_allclose(scan["direction"][...], direction, atol=1e-9)
            self.assertEqual(list(voxels.shape[::-1]), seen["scan"]["size"])
            k, j, i = numpy.indices(voxels.shape)
            place = origin + numpy.stack([i, j, k], -1) * scan["spacing"][...] @ scan["direction"][...].T
        self.assertLessEqual(abs(voxels - (place @ (10, 4, -6) - 300)).max(), 0.51)
        bodies = numpy.array([(0, 0, 0), (30, 0, 0), (0, 30, 0), (30, 30, 0), (0, 0, 30), (49, 0, 0), (40, 9, 0)]) @ direction
        for axis in range(3):  # a margin of 10 mm and less than a voxel more, all of it in the volume
            for side, ends in ((min, (bodies.min(0) - 10)), (max, (bodies.max(0) + 10))):
                end = side((place @ direction)[..., axis].min(), (place @ direction)[..., axis].max())
                self.assertLess(abs(end - ends[axis]), (2.01, 2.01, 5.01)[axis])
        self.assertEqual(run(BIN / "palpate-verify", self.asset).returncode, OK)

    def test_a_scan_beside_the_bodies_is_left_out_with_a_warning(self):
        write_volume(self.parts / "volume.nrrd", origin=(500.0, 0.0, 0.0))
        made = self.pack("--scan", self.parts / "volume.nrrd", "--json", "-")
        self.assertEqual(made.returncode, OK, made.stderr)
        self.assertIn("shows nothing of the bodies", made.stderr)
        self.assertIsNone(json.loads(made.stdout)["scan"])
        with h5py.File(self.asset) as file:
            self.assertNotIn("scan", file["palpate"])

    def test_colours_arrive_and_those_of_nothing_are_refused(self):
        made = self.pack("--colour", "skull=#e2d3b4", "--colour", "wall:1=#CC766C")
        self.assertEqual(made.returncode, OK, made.stderr)
        with h5py.File(self.asset) as file:
            self.assertEqual(file["palpate/bodies/rigid/0"].attrs["colour"], b"#e2d3b4")
            wall = file["palpate/bodies/deformable/0"]
            self.assertNotIn("colour", wall.attrs)
            self.assertEqual((wall["drawn_regions"][...].tolist(), wall["drawn_colours"][...].tolist()), ([1], [b"#cc766c"]))
        self.assertFails(self.pack("--force", "--colour", "brain=#000000"), INVALID, "colour of 'brain'")
        self.assertFails(self.pack("--force", "--colour", "skull:1=#000000"), INVALID, "colour of 'skull'")
        self.assertFails(self.pack("--force", "--colour", "wall:9=#000000"), INVALID, "colour of 'wall'")
        self.assertFails(self.pack("--force", "--colour", "wall=red"), USAGE, "'red' is no colour")

    def test_no_path_of_the_machine_gets_into_the_asset(self):
        self.assertEqual(self.pack().returncode, OK)
        self.assertNotIn(str(self.parts).encode(), self.asset.read_bytes())

    def test_a_path_in_the_provenance_is_refused(self):
        for text in ('{"steps": ["mesh /home/jane/head.nrrd"]}', '{"a": [{"C:\\\\data": 1}]}'):
            (self.folder / "given.json").write_text(text)
            self.assertFails(self.pack("--provenance", self.folder / "given.json"), INVALID, "holds a path")
        self.assertNothingLeft()

    def test_provenance_that_is_no_json_is_refused(self):
        for text in ("{", "[]", '{"a":' * 100000 + "1" + "}" * 100000):
            (self.folder / "given.json").write_text(text)
            self.assertFails(self.pack("--provenance", self.folder / "given.json"), INVALID, "given.json", "JSON")
        self.assertNothingLeft()

    def test_a_tree_of_another_surface_is_refused(self):
        made = run(BIN / "palpate-pack", "--name", "case", "--rigid",
                   f"skull={self.parts / 'skull.vtp'},{self.parts / 'wall.obb.h5'}", "-o", self.asset)
        self.assertFails(made, INVALID, "wall.obb.h5", "was built over another surface", "palpate obb")
        self.assertNothingLeft()

    def test_trees_that_are_not_given_are_built_as_obb_builds_them(self):
        given, built = self.folder / "given.vtkhdf", self.folder / "built.vtkhdf"
        self.assertEqual(self.pack(output=given).returncode, OK)
        made = run(BIN / "palpate-pack", "--name", "case", "--rigid", f"skull={self.parts / 'skull.vtp'}",
                   "--deformable", f"wall={self.parts / 'wall.body.h5'}", "-o", built)
        self.assertEqual(made.returncode, OK, made.stderr)
        self.assertEqual(built.read_bytes(), given.read_bytes())

    def test_parts_that_are_not_what_they_should_be_are_refused(self):
        made = run(BIN / "palpate-pack", "--name", "case", "--deformable",
                   f"wall={self.parts / 'wall.obb.h5'},{self.parts / 'wall.obb.h5'}", "-o", self.asset)
        self.assertFails(made, INVALID, "is of kind 'obb_tree'", "expected 'body'")
        made = run(BIN / "palpate-pack", "--name", "case", "--deformable", "wall=none.body.h5,none.obb.h5", "-o", self.asset)
        self.assertFails(made, INVALID, "none.body.h5", "No such file")
        self.assertNothingLeft()

    def test_wrong_arguments_are_usage_errors(self):
        for text in ("skull", "skull=", "=a,b", "skull=,b", "skull=a,"):
            made = run(BIN / "palpate-pack", "--name", "case", "--rigid", text, "-o", self.asset)
            self.assertFails(made, USAGE, "NAME=SURFACE.vtp,TREE.obb.h5")
        self.assertNothingLeft()

    def test_a_case_without_bodies_or_with_silly_settings_is_refused(self):
        self.assertFails(run(BIN / "palpate-pack", "--name", "case", "-o", self.asset), INVALID, "has no bodies")
        self.assertFails(self.pack("--tool-radius", 0), INVALID, "tool_radius is 0")
        self.assertNothingLeft()

    def test_an_existing_asset_is_kept_unless_forced(self):
        self.asset.write_text("precious")
        self.assertFails(self.pack(), INVALID, "exists already", "--force")
        self.assertEqual(self.asset.read_text(), "precious")
        self.assertEqual(self.pack("--force").returncode, OK)

    def test_a_full_disk_leaves_nothing_behind(self):
        def small_files():
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (40_000, 40_000))

        self.assertFails(self.pack(preexec_fn=small_files), FAILED, "could not be written", "free space")
        self.assertNothingLeft()


class InspectAndVerify(AssetCommand):
    def test_inspect_counts_what_is_there(self):
        seen = json.loads(run(BIN / "palpate-inspect", self.sample(), "--json", "-").stdout)
        wall = next(body for body in seen["bodies"] if body["name"] == "wall")
        self.assertEqual((wall["nodes"], wall["tetrahedra"], wall["surface_nodes"], wall["contact_nodes"]), (125, 384, 98, 73))
        self.assertAlmostEqual(wall["compliance_mb"], (3 * 73) ** 2 * 4e-6)
        moduli = {row["region"]: row["youngs_modulus_kpa"] for row in seen["regions"]}
        self.assertEqual(moduli, {"tissue": 5.0, "tumour": 40.0})
        self.assertAlmostEqual(sum(row["volume_ml"] for row in seen["regions"]), 8.0)

    def test_inspect_fits_on_a_screen(self):
        shown = run(BIN / "palpate-inspect", self.sample()).stdout
        self.assertLessEqual(len(shown.splitlines()), 40)
        self.assertIn("tumour", shown)

    def test_verify_says_which_check_fails_and_exits_with_4(self):
        checked = run(BIN / "palpate-verify", self.sample())  # its compliance is no stiffness's inverse
        self.assertFails(checked, QUALITY, "checks failed, first 'wall: residual of 16 re-solved columns'")
        self.assertRegex(checked.stdout, r"residual of 16 re-solved columns +failed")
        self.assertRegex(checked.stdout, r"compliance is symmetric.* ok")

    def test_verify_names_the_dataset_that_is_damaged(self):
        path = self.sample()
        with h5py.File(path) as file:
            offset = file["palpate/bodies/deformable/0/compliance/dense"].id.get_offset()
        data = bytearray(path.read_bytes())
        data[offset + 4] ^= 1
        path.write_bytes(data)
        self.assertFails(run(BIN / "palpate-verify", path), INVALID, "compliance/dense: does not match its SHA-256")

    def test_both_refuse_a_truncated_asset(self):
        path = self.sample()
        size = path.stat().st_size
        os.truncate(path, size - 1000)
        for command in ("inspect", "verify"):
            self.assertFails(run(BIN / f"palpate-{command}", path), INVALID,
                             f"case.vtkhdf: is truncated: {size - 1000} bytes (expected {size})")

    def test_both_refuse_a_newer_schema(self):
        path = self.sample()
        with h5py.File(path, "r+", libver=("v110", "v110")) as file:
            file["palpate"].attrs.get_id("schema").write(numpy.array(3, "i4"))
        for command in ("inspect", "verify"):
            self.assertFails(run(BIN / f"palpate-{command}", path), INVALID, "has schema 3", "use a newer palpate")

    def test_both_refuse_what_is_no_asset(self):
        self.asset.write_text("hello")
        for command in ("inspect", "verify"):
            self.assertFails(run(BIN / f"palpate-{command}", self.asset), INVALID, "is not an HDF5 file")
            self.assertFails(run(BIN / f"palpate-{command}", self.folder / "none"), INVALID, "no such file")
            self.assertFails(run(BIN / f"palpate-{command}"), USAGE)
        self.assertFails(run(BIN / "palpate-verify", self.sample(), "--columns", 0), USAGE, "--columns")


class Specification(AssetCommand):
    def test_the_reader_in_the_specification_reads_an_asset(self):
        code = re.search(r"```python\n(.*?)```", (SOURCE / "formats/asset/SPEC.md").read_text(), re.S).group(1)
        read = run(sys.executable, "-c", code, self.sample())
        self.assertEqual(read.returncode, OK, read.stderr)
        self.assertEqual(read.stdout, "wall 384 tetrahedra, 73 contact nodes\n")

    def test_the_reader_in_the_specification_finds_a_flipped_byte(self):
        code = re.search(r"```python\n(.*?)```", (SOURCE / "formats/asset/SPEC.md").read_text(), re.S).group(1)
        path = self.sample()
        with h5py.File(path, "r+", libver=("v110", "v110")) as file:
            file["palpate/haptics"].attrs.get_id("max_force").write(numpy.array(9.0))
        read = run(sys.executable, "-c", code, path)
        self.assertIn("AssertionError: manifest", read.stderr)

    def test_every_object_of_an_asset_is_in_the_specification(self):
        text = (SOURCE / "formats/asset/SPEC.md").read_text()
        for form in ([], ["hierarchical"]):
            subprocess.run([SAMPLE, self.asset, *form], check=True)
            with h5py.File(self.asset) as file:
                names = []
                file.visititems(lambda path, node: names.extend([path, *node.attrs]))
            for name in {part for path in names for part in path.split("/") if not part.isdigit()}:
                self.assertRegex(text, rf"\b{re.escape(name)}\b")

    def test_the_reader_of_a_compliance_in_the_specification_finds_the_same_in_both_forms(self):
        code = re.findall(r"```python\n(.*?)```", (SOURCE / "formats/asset/SPEC.md").read_text(), re.S)[1]
        reader = {}
        exec(code, reader)
        blocks = []
        for form in ([], ["hierarchical"]):
            subprocess.run([SAMPLE, self.asset, *form], check=True)
            with h5py.File(self.asset) as file:
                body = file["palpate/bodies/deformable/0"]
                nodes = len(body["contact_nodes"])
                blocks.append(numpy.array([reader["block"](body["compliance"], a, b)
                                           for a in range(0, nodes, 5) for b in range(0, nodes, 4)]))
        # The writer's accuracy, of entries of at most 1 mm/N, and the rounding of factors to 16 bits.
        self.assertLess(abs(blocks[0] - blocks[1]).max(), 1e-4 + 1e-3)
        self.assertGreater(abs(blocks[0] - blocks[1]).max(), 0)


if __name__ == "__main__":
    unittest.main()
