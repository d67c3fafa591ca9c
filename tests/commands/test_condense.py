# SPDX-License-Identifier: Apache-2.0
"""palpate condense: rules that hold and let touch, elements, bodies it refuses, and what an interrupt leaves."""
import contextlib
import itertools
import json
import os
import pathlib
import signal
import subprocess
import tempfile
import unittest
import unittest.mock

import h5py
import numpy

BIN = pathlib.Path(os.environ["PALPATE_BIN"])

OK, USAGE, INVALID, INTERRUPTED = 0, 2, 3, 130


def block(cells, corner=(0, 0, 0)):
    """Points and tetrahedra of cells of 1 mm, cut as Kuhn does: one tetrahedron for each order of the three axes."""
    nx, ny, nz = cells
    points = [(corner[0] + i, corner[1] + j, corner[2] + k)
              for k in range(nz + 1) for j in range(ny + 1) for i in range(nx + 1)]
    steps = (1, nx + 1, (nx + 1) * (ny + 1))
    first = numpy.array([i * steps[0] + j * steps[1] + k * steps[2]
                         for k in range(nz) for j in range(ny) for i in range(nx)])
    tetrahedra = []
    for order in itertools.permutations(range(3)):
        way = [0, *numpy.cumsum([steps[axis] for axis in order])]
        if numpy.linalg.det(numpy.eye(3)[list(order)]) < 0:
            way[2], way[3] = way[3], way[2]
        tetrahedra.append(first[:, None] + numpy.array(way))
    return points, numpy.concatenate(tetrahedra)


def joined(*blocks):
    """Several blocks as one mesh; nodes at one place become one."""
    number, tetrahedra = {}, []
    for points, cells in blocks:
        nodes = numpy.array([number.setdefault(point, len(number)) for point in points])
        tetrahedra.append(nodes[cells])
    return list(number), numpy.concatenate(tetrahedra)


def write_mesh(path, points, tetrahedra, regions=None, outside=None):
    """A .vtu with regions 1 'liver' and 2 'tumour', and beyond its surface 0 or 9 'skull'."""
    def array(name, kind, values, more=""):
        flat = " ".join(map(str, numpy.asarray(values).ravel().tolist()))
        return f'<DataArray type="{kind}" Name="{name}" {more} format="ascii">{flat}</DataArray>'

    def texts(name, values):
        return array(name, "String", [c for value in values for c in [*value.encode(), 0]], f'NumberOfTuples="{len(values)}"')

    def integers(name, values):
        return array(name, "Int32", values, f'NumberOfTuples="{len(values)}"')

    count = len(tetrahedra)
    path.write_text(
        '<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" header_type="UInt64">'
        f'<UnstructuredGrid><FieldData>{texts("region_names", ["liver", "tumour"])}{integers("region_values", [1, 2])}'
        f'{texts("outside_names", ["skull"])}{integers("outside_values", [9])}</FieldData>'
        f'<Piece NumberOfPoints="{len(points)}" NumberOfCells="{count}">'
        f'<PointData>{"" if outside is None else array("outside_label", "Int32", outside)}</PointData>'
        f'<CellData>{array("region", "Int32", [1] * count if regions is None else regions)}</CellData>'
        f'<Points>{array("Points", "Float64", points, "NumberOfComponents=" + chr(34) + "3" + chr(34))}</Points>'
        f'<Cells>{array("connectivity", "Int64", tetrahedra)}{array("offsets", "Int64", range(4, 4 * count + 1, 4))}'
        f'{array("types", "UInt8", [10] * count)}</Cells></Piece></UnstructuredGrid></VTKFile>')


class Condense(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.mesh, self.body = self.folder / "liver.vtu", self.folder / "liver.body.h5"

    def write_organ(self):
        """4 x 4 x 4 mm, 125 nodes; the uppermost layer is tumour, and skull lies below."""
        points, tetrahedra = block((4, 4, 4))
        height = numpy.array(points)[:, 2]
        write_mesh(self.mesh, points, tetrahedra, numpy.where(height[tetrahedra].min(axis=1) == 3, 2, 1),
                   numpy.where(height == 0, 9, 0))

    def condense(self, *rules, materials=("liver:6,0.45", "tumour:30,0.45")):
        arguments = [argument for material in materials for argument in ("--material", material)]
        return subprocess.run([BIN / "palpate-condense", self.mesh, *arguments, *map(str, rules), "-o", self.body, "--json", "-"],
                              text=True, timeout=200, stdout=subprocess.PIPE, stderr=subprocess.PIPE)

    def result_of(self, *rules, **options):
        self.body.unlink(missing_ok=True)
        made = self.condense(*rules, **options)
        self.assertEqual(made.returncode, OK, made.stderr)
        return json.loads(made.stdout)

    def compliance(self):
        with h5py.File(self.body) as file:
            body = file["palpate/body"]
            return list(body["contact_nodes"]), body["compliance/dense"][...].astype(float)

    def assert_refused(self, code, phrases, *rules, **options):
        present = sorted(self.folder.iterdir())
        refused = self.condense(*rules, **options)
        self.assertEqual(refused.returncode, code, refused.stderr)
        for phrase in phrases:
            self.assertIn(phrase, refused.stderr)
        self.assertNotIn("factorising", refused.stderr)
        self.assertEqual(sorted(self.folder.iterdir()), present, "something was left behind")

    def test_without_a_contact_rule_every_free_surface_node_can_be_touched(self):
        self.write_organ()
        result = self.result_of("--fixed", "touching:skull")
        self.assertEqual((result["nodes"], result["surface_nodes"], result["fixed_nodes"], result["contact_nodes"]),
                         (125, 98, 25, 73))
        self.assertEqual(result["element_order"], "linear")

    def test_the_contact_surface_is_a_part_of_the_whole_compliance(self):
        self.write_organ()
        self.result_of("--fixed", "touching:skull")
        all_nodes, whole = self.compliance()
        result = self.result_of("--fixed", "touching:skull", "--contact", "region:tumour")
        nodes, part = self.compliance()
        self.assertEqual(result["contact_nodes"], len(nodes))
        self.assertEqual(nodes, [n for n in range(75, 125) if n >= 100 or n in all_nodes])  # the layer's surface
        rows = [3 * all_nodes.index(node) + axis for node in nodes for axis in range(3)]
        # Both are stored as float32, 6e-8 of each entry.
        numpy.testing.assert_allclose(part, whole[numpy.ix_(rows, rows)], rtol=0, atol=2e-7 * whole.max())

    def test_rules_add_up_and_fixed_nodes_cannot_be_touched(self):
        self.write_organ()
        result = self.result_of("--fixed", "touching:skull", "--fixed", "sphere:4,4,4,0.5",
                                "--contact", "plane:4,0,0,1,0,0", "--contact", "box:0,0,0,0,0,4")
        self.assertEqual(result["fixed_nodes"], 26)
        self.assertEqual(result["contact_nodes"], 20 - 1 + 4)

    def test_node_files_hold_interior_nodes_too(self):
        self.write_organ()
        (self.folder / "held.txt").write_text("# the middle\n62\n0\n4 # a corner\n20\n")
        (self.folder / "touched.txt").write_text("124\n120\n")
        result = self.result_of("--fixed", f"nodes:{self.folder / 'held.txt'}", "--contact", f"nodes:{self.folder / 'touched.txt'}")
        self.assertEqual((result["fixed_nodes"], result["contact_nodes"]), (4, 2))
        self.assertEqual(self.compliance()[0], [120, 124])

    def rest_positions(self):
        with h5py.File(self.body) as file:
            return file["palpate/body/rest_positions"][...]

    def test_another_posture_moves_the_body_and_says_how_far(self):
        self.write_organ()
        held = ["--fixed", "touching:skull"]
        densities = ["--density", "liver:1060", "--density", "tumour:1100"]
        self.assertIsNone(self.result_of(*held, *densities)["sag"])
        scanned = self.rest_positions()
        result = self.result_of(*held, *densities, "--scanned", "supine", "--posture", "left_side")
        moved = self.rest_positions() - scanned
        self.assertAlmostEqual(numpy.linalg.norm(moved, axis=1).max(), result["sag"]["largest_displacement_mm"], places=9)
        self.assertGreater(result["sag"]["largest_displacement_mm"], 1e-3)
        top = moved[scanned[:, 2] == 4]
        self.assertTrue((top[:, 0] > 0).all() and (top[:, 1] < 0).all(), "to the left, and up from the back")
        self.assertEqual(abs(moved[scanned[:, 2] == 0]).max(), 0)
        self.body.unlink()
        self.assert_refused(USAGE, ["posture", "--scanned"], *held, *densities, "--posture", "prone")
        self.assert_refused(USAGE, ["sitting", "upright"], *held, *densities, "--scanned", "supine", "--posture", "sitting")
        self.assert_refused(INVALID, ["'tumour'", "density"], *held, "--density", "liver:1060", "--scanned", "supine",
                            "--posture", "prone")
        self.assert_refused(USAGE, ["--density liver", "liver:1060"], *held, "--density", "liver")

    def test_a_relaxation_is_stored_by_region_and_refused_where_it_makes_no_sense(self):
        self.write_organ()
        held = ["--fixed", "touching:skull"]
        self.result_of(*held, "--relaxation", "liver:0.3,1", "--relaxation", "liver:0.2,10")
        with h5py.File(self.body) as file:
            self.assertEqual(file["palpate/body/relaxation"][...].tolist(), [[0.3, 1], [0.2, 10]])
            self.assertEqual(file["palpate/body/relaxation_regions"][...].tolist(), [1, 1])
        self.body.unlink()
        self.assert_refused(INVALID, ["'liver'", "relaxation"], *held, "--relaxation", "liver:1.2,1")
        self.assert_refused(USAGE, ["--relaxation liver:0.3", "liver:0.3,1"], *held, "--relaxation", "liver:0.3")

    def test_quadratic_tetrahedra_give_way_more_than_linear_ones(self):
        self.write_organ()
        arguments = ["--fixed", "touching:skull", "--contact", "sphere:2,2,4,0.1"]
        linear = self.result_of(*arguments)
        stiff = self.compliance()[1]
        quadratic = self.result_of(*arguments, "--element", "quadratic")
        soft = self.compliance()[1]
        self.assertEqual((linear["element_order"], quadratic["element_order"]), ("linear", "quadratic"))
        self.assertEqual(linear["certificate"]["free_dofs"], 300)
        self.assertEqual(quadratic["certificate"]["free_dofs"], 3 * (9 ** 3 - 9 ** 2))  # nodes of 0.5 mm cells
        # The larger space's minimum is lower (Ritz), so a force on one node always does more work.
        self.assertGreater(numpy.linalg.eigvalsh(soft - stiff).min(), 0)

    def test_as_many_threads_are_taken_as_are_given_or_as_the_environment_says(self):
        self.write_organ()
        rule = "--fixed", "plane:0,0,0,0,0,-1"
        with unittest.mock.patch.dict(os.environ, PALPATE_THREADS="3"):
            self.assertEqual(self.result_of(*rule)["plan"]["threads"], 3)
            self.assertEqual(self.result_of(*rule, "--threads", "2", "--force")["plan"]["threads"], 2)
        self.body.unlink()
        for text in ("two", "0", "-1", "2x"):
            with unittest.mock.patch.dict(os.environ, PALPATE_THREADS=text):
                self.assert_refused(USAGE, ("PALPATE_THREADS", "an integer above 0"), *rule)

    def test_wrong_rules_are_usage_errors(self):
        self.write_organ()
        for option, rule, phrases in (("--fixed", "sphere:1,2,3", ("--fixed sphere:1,2,3", "x,y,z,radius")),
                                      ("--contact", "ball:1", ("--contact 'ball:1'", "region:NAME")),
                                      ("--contact", "box:0,0,0,1,1,nan", ("--contact box", "'nan' is not a number"))):
            self.assert_refused(USAGE, phrases, option, rule)
        self.assert_refused(USAGE, ("--element quadratc", "linear or quadratic"), "--element", "quadratc")
        self.assert_refused(USAGE, ("--material liver:inf,0.45", "REGION:"), materials=("liver:inf,0.45", "tumour:30,0.45"))

    def test_rules_that_do_not_fit_the_mesh_are_refused(self):
        self.write_organ()
        held = ("--fixed", "touching:skull", "--contact")
        self.assert_refused(INVALID, ("--fixed touching:skul", "skull"), "--fixed", "touching:skul")
        self.assert_refused(INVALID, ("--contact region:tumor", "tumour"), *held, "region:tumor")
        self.assert_refused(INVALID, ("--contact sphere:50,0,0,1", "picks no node"), *held, "sphere:50,0,0,1")
        self.assert_refused(INVALID, ("every node picked is fixed",), *held, "touching:skull")
        nodes = self.folder / "nodes.txt"
        for line, phrase in (("125", "'125' is not the index of a node"), ("x", "'x'"), ("62", "node 62 lies inside")):
            nodes.write_text(f"124\n{line}\n")
            self.assert_refused(INVALID, (f"{nodes}:2", phrase), *held, f"nodes:{nodes}")
        self.assert_refused(INVALID, ("none.txt", "cannot be read"), *held, f"nodes:{self.folder / 'none.txt'}")

    def test_a_loose_part_is_named_by_place_and_size(self):
        write_mesh(self.mesh, *joined(block((3, 3, 3)), block((1, 2, 1), (10, 20, 30))))
        self.assert_refused(INVALID, ("its part of 12 tetrahedra around (11, 21, 31) mm, 1.0 x 2.0 x 1.0 mm",
                                      "no node is held", "--keep-largest"),
                            "--fixed", "plane:0,0,0,0,0,-1", materials=("liver:6,0.45",))
        result = self.result_of("--fixed", "plane:0,0,0,0,0,-1", "--fixed", "plane:0,0,31,0,0,1", materials=("liver:6,0.45",))
        self.assertEqual(result["fixed_nodes"], 16 + 6)

    def test_a_part_that_hangs_by_an_edge_is_named_with_its_axis(self):
        write_mesh(self.mesh, *joined(block((3, 3, 3)), block((2, 2, 1), (3, 3, 1))))
        self.assert_refused(INVALID, ("its part of 24 tetrahedra around (4, 4, 2) mm", "through (3.0, 3.0, 1.0) mm",
                                      "along (0.000, 0.000, 1.000)", "without the hinge"),
                            "--fixed", "plane:0,0,0,0,0,-1", materials=("liver:6,0.45",))

    def interrupt(self, ready):
        """Condenses a body that takes seconds, waits until `ready(process)`, and interrupts; returns exit code and talk."""
        process = subprocess.Popen([BIN / "palpate-condense", self.mesh, "--material", "liver:6,0.45",
                                    "--fixed", "plane:0,0,0,0,0,-1", "-o", self.body, "--json", self.folder / "result.json"],
                                   stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        with process:
            ready(process)
            process.send_signal(signal.SIGINT)
            said = process.stderr.read()
        return process.returncode, said

    def test_an_interrupt_leaves_nothing_behind_whatever_is_being_computed(self):
        write_mesh(self.mesh, *block((17, 17, 17)))
        reached = []
        for lines in range(1, 8):  # a line for each thing it says and does
            with self.subTest(lines=lines):
                code, said = self.interrupt(lambda process: reached.extend(process.stderr.readline() for _ in range(lines)))
                self.assertEqual(code, INTERRUPTED, said)
                self.assertIn("interrupted; nothing half written was left behind", said)
                self.assertEqual(list(self.folder.iterdir()), [self.mesh])
        self.assertTrue(any("factorising" in line for line in reached), reached)

    def test_an_interrupt_leaves_nothing_behind_while_the_body_is_being_written(self):
        write_mesh(self.mesh, *block((14, 14, 14)))  # 35 MB of compliance
        seen = []

        def being_written(process):
            # It has no name yet, but a process's open files tell where they lie and how long they are.
            files = pathlib.Path(f"/proc/{process.pid}/fd")
            while process.poll() is None and not seen:
                with contextlib.suppress(OSError):
                    seen.extend(file for file in files.iterdir() if os.readlink(file).startswith(f"{self.folder}/#") and file.stat().st_size > 0)

        for _ in range(5):  # a busy machine may let it finish before the signal arrives
            code, said = self.interrupt(being_written)
            if code == INTERRUPTED:
                break
            self.body.unlink()
            (self.folder / "result.json").unlink()
            seen.clear()
        self.assertEqual(code, INTERRUPTED, said)
        self.assertTrue(seen)
        self.assertEqual(list(self.folder.iterdir()), [self.mesh])


if __name__ == "__main__":
    unittest.main()
