# SPDX-License-Identifier: GPL-3.0-or-later
"""palpate surface, palpate mesh and palpate obb: results, exit codes, outputs whole or not at all."""
import gzip
import json
import os
import pathlib
import signal
import struct
import subprocess
import tempfile
import time
import unittest

BIN = pathlib.Path(os.environ["PALPATE_BIN"])
DATA = pathlib.Path(os.environ.get("PALPATE_DATA", ""))

OK, USAGE, INVALID, QUALITY, INTERRUPTED = 0, 2, 3, 4, 130

SIZE = (44, 44, 34)
ORGAN, LESION, ISLAND = 3, 7, 9


def label_at(i, j, k):
    """An organ of 15 mm radius, an enclosed lesion of 6 mm, and a label of two balls."""
    def within(center, radius):
        return sum((a - b) ** 2 for a, b in zip((i, j, k), center)) < radius ** 2
    if within((20, 20, 17), 6):
        return LESION
    if within((18, 20, 17), 15):
        return ORGAN
    return ISLAND if within((38, 38, 8), 5) or within((38, 38, 26), 4) else 0


def write_inputs(folder):
    voxels = bytes(label_at(i, j, k) for k in range(SIZE[2]) for j in range(SIZE[1]) for i in range(SIZE[0]))
    geometry = (f"dimension: 3\nspace: left-posterior-superior\nsizes: {SIZE[0]} {SIZE[1]} {SIZE[2]}\n"
                "space directions: (0.8,0.6,0) (-0.6,0.8,0) (0,0,1)\nkinds: domain domain domain\n"
                "endian: little\nencoding: gzip\nspace origin: (-30,12,100)\n")
    segments = "".join(f"Segment{n}_ID:=s{n}\nSegment{n}_Layer:=0\nSegment{n}_Name:={name}\n"
                       f"Segment{n}_LabelValue:={value}\n"
                       for n, (name, value) in enumerate((("organ", ORGAN), ("lesion", LESION), ("islands", ISLAND))))
    (folder / "labels.seg.nrrd").write_bytes(f"NRRD0004\ntype: uint8\n{geometry}{segments}\n".encode()
                                             + gzip.compress(voxels, 1, mtime=0))
    hounsfield = struct.pack(f"<{len(voxels)}h", *(40 if v == ORGAN else 400 if v else -1000 for v in voxels))
    (folder / "volume.nrrd").write_bytes(f"NRRD0004\ntype: int16\n{geometry}\n".encode()
                                         + gzip.compress(hounsfield, 1, mtime=0))


class MeshingCommand(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.inputs = tempfile.TemporaryDirectory()
        folder = pathlib.Path(cls.inputs.name)
        write_inputs(folder)
        cls.labels, cls.volume = folder / "labels.seg.nrrd", folder / "volume.nrrd"

    @classmethod
    def tearDownClass(cls):
        cls.inputs.cleanup()

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def run_command(self, name, *arguments):
        return subprocess.run([BIN / f"palpate-{name}", *map(str, arguments)], text=True, timeout=200,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE)

    def result_of(self, name, *arguments):
        run = self.run_command(name, *arguments, "--json", "-")
        self.assertEqual(run.returncode, OK, run.stderr)
        return json.loads(run.stdout)

    def expect_refusal(self, code, phrases, name, *arguments):
        run = self.run_command(name, *arguments)
        self.assertEqual(run.returncode, code, run.stderr)
        for phrase in phrases:
            self.assertIn(phrase, run.stderr)
        self.assertEqual(list(self.folder.iterdir()), [], "an output was left behind")


class Mesh(MeshingCommand):
    def mesh(self, *more):
        return ("--labels", self.labels, "--region", "organ", "--region", "lesion", "--cell-size", 3, "-o",
                self.folder / "organ.vtu", *more)

    def test_result_tells_size_shape_and_fidelity(self):
        result = self.result_of("mesh", *self.mesh())
        self.assertEqual(result["components"], 1)
        self.assertEqual(result["boundary_non_manifold_edges"], 0)
        self.assertEqual(sum(result["dihedral_histogram_10_deg"]), 6 * result["tetrahedra"])
        self.assertGreater(result["nodes"], result["surface_nodes"])
        self.assertEqual([r["name"] for r in result["regions"]], ["organ", "lesion"])
        for region in result["regions"]:
            self.assertLess(abs(region["volume_error_percent"]), 0.1)
            self.assertGreater(region["dice"], 0.98)
            self.assertLess(region["centroid_distance_mm"], 0.05)
            self.assertLess(region["surface_distance_mm"]["mean"], 0.1)  # the facet distance is 0.3
        self.assertEqual(result["attempts"], [{"tetrahedra": result["tetrahedra"], "misses": []}])
        checks = {check["name"]: check for check in result["checks"]}
        self.assertEqual([(checks[name]["bound"], checks[name]["limit"], checks[name]["unit"], checks[name]["met"])
                          for name in ("min_dihedral_deg", "max_dihedral_deg")],
                         [("at least", 12, "degrees", True), ("at most", 165, "degrees", True)])
        self.assertEqual(checks["min_dihedral_deg"]["value"], result["min_dihedral_deg"])
        self.assertEqual(checks["min_dice"]["value"], result["dice"])

    def test_missed_limits_are_listed_with_every_attempt(self):
        result = self.result_of("mesh", *self.mesh("--max-mean-distance", 0.04, "--attempts", 8))
        first, last = result["attempts"][0], result["attempts"][-1]
        self.assertEqual(first["misses"][0]["name"], "max_mean_distance_mm")
        self.assertGreater(first["misses"][0]["value"], 0.04)
        self.assertEqual(last, {"tetrahedra": result["tetrahedra"], "misses": []})
        self.assertGreater(last["tetrahedra"], first["tetrahedra"])

    def test_every_run_at_any_thread_count_gives_the_same_bytes(self):
        self.result_of("mesh", *self.mesh())
        first = (self.folder / "organ.vtu").read_bytes()
        for threads in (1, 2, 8):
            self.result_of("mesh", *self.mesh("--force", "--threads", threads))
            self.assertEqual((self.folder / "organ.vtu").read_bytes(), first, f"{threads} threads")

    def test_region_cell_size_refines(self):
        coarse = self.result_of("mesh", *self.mesh())
        fine = self.result_of("mesh", *self.mesh("--region-cell-size", "lesion=1", "--force"))
        self.assertGreater(fine["tetrahedra"], 2 * coarse["tetrahedra"])

    def test_missed_contract_names_the_worst_places(self):
        self.expect_refusal(QUALITY, ["smallest dihedral angle is", " at (", "at least 70°"], "mesh",
                            *self.mesh("--min-dihedral-deg", 70))
        self.expect_refusal(QUALITY, ["Dice coefficient of the body", "0.99999", "after 2 meshes"], "mesh",
                            *self.mesh("--min-dice", 0.99999, "--attempts", 2))

    def test_cells_near_a_label_or_a_point_are_finer(self):
        coarse = self.result_of("mesh", *self.mesh())
        for place in ("lesion=1,3", "-27.6,38.8,117=1,6"):
            fine = self.result_of("mesh", *self.mesh("--near", place, "--force"))
            self.assertGreater(fine["tetrahedra"], 1.5 * coarse["tetrahedra"], place)
        for text in ("lesion", "lesion=1", "=1,2,3", "1,2=3,x"):
            run = self.run_command("mesh", *self.mesh("--near", text, "--force"))
            self.assertEqual(run.returncode, USAGE, run.stderr)
            self.assertIn("--near", run.stderr)

    def test_unknown_label_is_answered_with_the_nearest(self):
        self.expect_refusal(INVALID, ["no label 'lesoin'", "'lesion'"], "mesh", "--labels", self.labels, "--region",
                            "lesoin", "-o", self.folder / "x.vtu")

    def test_body_of_two_pieces_is_refused_unless_allowed(self):
        arguments = ("--labels", self.labels, "--region", "islands", "-o", self.folder / "x.vtu")
        self.expect_refusal(INVALID, ["2 separate pieces", "--allow-components"], "mesh", *arguments)
        self.assertEqual(self.result_of("mesh", *arguments, "--allow-components")["components"], 2)

    def test_malformed_region_size_is_a_usage_error(self):
        for text in ("lesion", "lesion=", "lesion=fine", "=3"):
            self.expect_refusal(USAGE if text != "=3" else INVALID, [], "mesh",
                                *self.mesh("--region-cell-size", text))

    def test_sizes_that_make_no_sense_are_refused(self):
        self.expect_refusal(INVALID, ["cell size"], "mesh", "--labels", self.labels, "--region", "organ",
                            "--cell-size", 0, "-o", self.folder / "x.vtu")

    def test_full_disk_leaves_nothing_behind(self):
        script = f"ulimit -f 8; exec {BIN}/palpate-mesh " + " ".join(f"'{a}'" for a in self.mesh())
        run = subprocess.run(["bash", "-c", f"trap '' XFSZ; {script}"], text=True, stdout=subprocess.PIPE,
                             stderr=subprocess.PIPE)
        self.assertEqual(run.returncode, 1, run.stderr)
        self.assertIn("could not be written", run.stderr)
        self.assertEqual(list(self.folder.iterdir()), [])

    def test_interrupt_leaves_nothing_behind(self):
        process = subprocess.Popen([BIN / "palpate-mesh", "--labels", self.labels, "--region", "organ", "--cell-size", "0.4",
                                    "-o", self.folder / "x.vtu"], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        time.sleep(1)
        self.assertIsNone(process.poll(), "it was done before it could be interrupted")
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=20)
        self.assertEqual(process.returncode, INTERRUPTED)
        self.assertEqual(list(self.folder.iterdir()), [])


class Surface(MeshingCommand):
    def test_labels_give_a_surface_of_their_volume(self):
        result = self.result_of("surface", "--labels", self.labels, "--label", "organ", "--label", LESION, "-o",
                                self.folder / "organ.vtp")
        self.assertEqual(result["pieces"], 1)
        self.assertAlmostEqual(result["volume_mm3"] / (4 / 3 * 3.14159 * 15 ** 3), 1, delta=0.01)

    def test_volume_gives_the_isosurface_that_labels_mask(self):
        output = self.folder / "out.vtp"
        everything = self.result_of("surface", "--volume", self.volume, "--isovalue", 226, "-o", output)
        self.assertEqual(everything["pieces"], 3)
        masked = self.result_of("surface", "--volume", self.volume, "--isovalue", 226, "--labels", self.labels,
                                "--label", "islands", "-o", output, "--force")
        self.assertEqual(masked["pieces"], 2)
        largest = self.result_of("surface", "--volume", self.volume, "--isovalue", 226, "--keep-largest",
                                 "--max-triangles", 300, "-o", output, "--force")
        self.assertEqual(largest["pieces"], 1)
        self.assertLessEqual(largest["triangles"], 300)
        self.assertLess(largest["decimation"]["max_distance_mm"], 0.5)

    def test_useless_arguments_are_refused(self):
        output = ("-o", self.folder / "x.vtp")
        self.expect_refusal(USAGE, [], "surface", *output)
        self.expect_refusal(USAGE, [], "surface", "--volume", self.volume, *output)
        self.expect_refusal(USAGE, ["without the other"], "surface", "--labels", self.labels, *output)
        self.expect_refusal(INVALID, ["above every voxel"], "surface", "--volume", self.volume, "--isovalue", 5000,
                            *output)
        self.expect_refusal(USAGE, [], "surface", "--surface-file", "x.stl", "--labels", self.labels, *output)
        self.expect_refusal(INVALID, ["no such file"], "surface", "--volume", "absent.nrrd", "--isovalue", 1, *output)


    def test_decimation_keeps_the_distance_asked_for_or_says_where_it_cannot(self):
        arguments = ("--labels", self.labels, "--label", "organ", "--label", "lesion", "--max-triangles", 300)
        decimation = self.result_of("surface", *arguments, "--max-distance", 0.5, "-o",
                                    self.folder / "a.vtp")["decimation"]
        self.assertLessEqual(decimation["max_distance_mm"], 0.5)
        self.assertEqual(len(decimation["max_distance_at_mm"]), 3)
        self.assertEqual(decimation["self_intersecting_pairs"], 0)
        (self.folder / "a.vtp").unlink()
        self.expect_refusal(QUALITY, ["300 triangles stay", "mm off at ("], "surface", *arguments, "--max-distance",
                            0.001, "-o", self.folder / "x.vtp")

    def test_imported_surface_is_taken_in_its_unit_or_refused_by_place(self):
        faces = ("2 3 4", "1 4 3", "1 2 4", "1 2 3")  # the last one faces inwards
        with tempfile.TemporaryDirectory() as elsewhere:
            sound, open_ = pathlib.Path(elsewhere) / "a.obj", pathlib.Path(elsewhere) / "b.obj"
            points = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
            sound.write_text(points + "".join(f"f {face}\n" for face in faces))
            open_.write_text(points + "".join(f"f {face}\n" for face in faces[:3]))
            result = self.result_of("surface", "--surface-file", sound, "--unit", "cm", "-o", self.folder / "a.vtp")
            self.assertAlmostEqual(result["volume_mm3"], 1000 / 6, places=3)
            (self.folder / "a.vtp").unlink()
            self.expect_refusal(INVALID, ["3 open edges, the first at (5.0, 0.0, 0.0)", "close its holes"], "surface",
                                "--surface-file", open_, "--unit", "cm", "-o", self.folder / "x.vtp")


class Obb(MeshingCommand):
    def test_surface_and_tetrahedra_get_their_trees(self):
        surface, mesh = self.folder / "organ.vtp", self.folder / "organ.vtu"
        triangles = self.result_of("surface", "--labels", self.labels, "--label", "organ", "-o", surface)["triangles"]
        tree = self.result_of("obb", surface, "-o", self.folder / "a.obb.h5")
        self.assertEqual(tree["triangles"], triangles)
        self.assertEqual(tree["boxes"], 2 * tree["leaves"] - 1)
        self.result_of("mesh", "--labels", self.labels, "--region", "organ", "--region", "lesion", "-o", mesh)
        self.result_of("obb", mesh, "-o", self.folder / "b.obb.h5")
        self.assertGreater((self.folder / "b.obb.h5").stat().st_size, 0)

    def test_other_files_are_refused(self):
        self.expect_refusal(USAGE, [".vtp or .vtu"], "obb", self.labels, "-o", self.folder / "x.obb.h5")
        with tempfile.NamedTemporaryFile(suffix=".vtp") as text:
            text.write(b"no mesh")
            text.flush()
            self.expect_refusal(INVALID, ["not a readable"], "obb", text.name, "-o", self.folder / "x.obb.h5")


@unittest.skipUnless((DATA / "head_ct_cranium").is_dir(), "PALPATE_DATA: head_ct_cranium is absent")
class RealHead(MeshingCommand):
    def test_skull_is_a_closed_surface_with_a_tree(self):
        skull = self.folder / "skull.vtp"
        result = self.result_of("surface", "--volume", DATA / "head_ct_cranium" / "head_ct_cranium.nrrd", "--isovalue",
                                226, "--keep-largest", "-o", skull)
        self.assertGreater(result["triangles"], 300_000)
        tree = self.result_of("obb", skull, "-o", self.folder / "skull.obb.h5")
        self.assertEqual(tree["triangles"], result["triangles"])

    def test_skull_of_a_triangle_budget_stays_within_the_distance_asked_for(self):
        result = self.result_of("surface", "--volume", DATA / "head_ct_cranium" / "head_ct_cranium.nrrd", "--isovalue",
                                226, "--keep-largest", "--max-triangles", 200_000, "--max-distance", 0.5, "-o",
                                self.folder / "skull.vtp")
        self.assertLessEqual(result["triangles"], 200_000)
        self.assertLessEqual(result["decimation"]["max_distance_mm"], 0.5)


@unittest.skipUnless((DATA / "cgal_images").is_dir(), "PALPATE_DATA: cgal_images is absent")
class RealSkull(MeshingCommand):
    def test_grey_skull_of_cgal_is_closed_and_decimates_within_a_tenth_of_a_voxel(self):
        content = gzip.decompress((DATA / "cgal_images" / "skull_2.9.inr.gz").read_bytes())
        header = dict(line.split("=", 1) for line in content[:256].decode().splitlines() if "=" in line)
        size = [int(header[axis + "DIM"]) for axis in "XYZ"]
        spacing = [float(header["V" + axis]) for axis in "XYZ"]
        kind = {"float": "float", "unsigned fixed": "uint8"}[header["TYPE"]]
        endian = "big" if header.get("CPU") in ("sun", "sgi") else "little"
        volume = self.folder / "skull.nrrd"
        volume.write_bytes(f"NRRD0004\ntype: {kind}\ndimension: 3\nspace: left-posterior-superior\nsizes: {size[0]} "
                           f"{size[1]} {size[2]}\nspace directions: ({spacing[0]},0,0) (0,{spacing[1]},0) "
                           f"(0,0,{spacing[2]})\nkinds: domain domain domain\nencoding: raw\nendian: {endian}\n"
                           "space origin: (0,0,0)\n\n".encode() + content[256:])
        result = self.result_of("surface", "--volume", volume, "--isovalue", 2.9, "--keep-largest", "--max-triangles",
                                20_000, "--max-distance", 0.4, "-o", self.folder / "skull.vtp")
        self.assertLessEqual(result["triangles"], 20_000)
        self.assertGreater(result["volume_mm3"], 1e5)


@unittest.skipUnless((DATA / "cgal_images").is_dir(), "PALPATE_DATA: cgal_images is absent")
class RealLiver(MeshingCommand):
    def test_liver_with_an_enclosed_tumour_keeps_its_contract(self):
        size, spacing, center, radius = (438, 353, 165), (0.617188, 0.617188, 1.33333), (106, 91, 129), 12
        voxels = bytearray(gzip.decompress((DATA / "cgal_images" / "liver.inr.gz").read_bytes())[256:])
        low = [int((c - radius) / s) for c, s in zip(center, spacing)]
        high = [int((c + radius) / s) + 1 for c, s in zip(center, spacing)]
        for k in range(low[2], high[2] + 1):
            for j in range(low[1], high[1] + 1):
                for i in range(low[0], high[0] + 1):
                    if sum((n * s - c) ** 2 for n, s, c in zip((i, j, k), spacing, center)) < radius ** 2:
                        voxels[(k * size[1] + j) * size[0] + i] = 200
        labels = self.folder / "liver.nrrd"
        labels.write_bytes(f"NRRD0004\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\nsizes: {size[0]} "
                           f"{size[1]} {size[2]}\nspace directions: ({spacing[0]},0,0) (0,{spacing[1]},0) "
                           f"(0,0,{spacing[2]})\nkinds: domain domain domain\nencoding: raw\nspace origin: (0,0,0)\n\n"
                           .encode() + voxels)
        result = self.result_of("mesh", "--labels", labels, "--region", 255, "--region", 200, "--cell-size", 9,
                                "--region-cell-size", "200=5", "--min-dihedral-deg", 12, "--max-dihedral-deg", 165,
                                "--max-volume-error-percent", 1, "--min-dice", 0.975, "-o", self.folder / "liver.vtu")
        self.assertEqual(result["components"], 1)
        self.assertEqual(result["boundary_non_manifold_edges"], 0)
        self.assertEqual(len(result["regions"]), 2)


if __name__ == "__main__":
    unittest.main()
