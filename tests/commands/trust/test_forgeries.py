# SPDX-License-Identifier: GPL-3.0-or-later
"""Assets whose values were changed and all digests made anew: touch refuses what could harm a hand, verify everything."""
import json
import pathlib
import shutil
import sys
import tempfile
import unittest

import h5py
import numpy

sys.path.insert(0, "..")
import test_asset_commands as assets  # noqa: E402
from forge import rehash  # noqa: E402
from sample_asset import SampleAsset  # noqa: E402

BIN, run = assets.BIN, assets.run
OK, INVALID, QUALITY = assets.OK, assets.INVALID, assets.QUALITY
SOFT = "palpate/bodies/deformable/0/"
HARD = "palpate/bodies/rigid/0/"
HUGE, LAST = 1e30, 2**31 - 1


def value(path, change):
    """Changes a dataset's values."""
    def forge(file):
        file[path][...] = change(file[path][...])
    return forge


def entry(path, index, to):
    def change(values):
        values = values.copy()
        values.reshape(-1)[index] = to
        return values
    return value(path, change)


def attribute(path, name, change):
    def forge(file):
        node = file[path]
        node.attrs.modify(name, numpy.array(change(node.attrs[name]), node.attrs[name].dtype))
    return forge


def to(number):
    return lambda _: number


def row_scaled(path, row, factor):
    def change(matrix):
        matrix = matrix.copy()
        matrix[row] *= factor
        matrix[:, row] *= factor
        return matrix
    return value(path, change)


def resized(path, change):
    """A dataset of another length in the same place."""
    def forge(file):
        values, attributes = file[path][...], dict(file[path].attrs)
        del file[path]
        made = file.create_dataset(path, data=change(values))
        for name, text in attributes.items():
            made.attrs[name] = text
    return forge


def replace_text(file, path, text):
    """Another text of the same length."""
    length = file[path].dtype.itemsize
    file[path][...] = numpy.array(text.encode().ljust(length), file[path].dtype)


SETTINGS = ("tool_radius", "coupling_stiffness", "max_force", "max_force_rate")
PHYSICS = {
    # what a body is
    "rest position nan": entry(SOFT + "rest_positions", 3, numpy.nan),
    "rest position infinite": entry(SOFT + "rest_positions", 3, numpy.inf),
    "rest position 1e300": entry(SOFT + "rest_positions", 3, 1e300),
    "rest position 100 m off": entry(SOFT + "rest_positions", 3, 1e5),
    "all positions scaled": value(SOFT + "rest_positions", lambda p: p * 1.5),
    "all positions of a quarter": value(SOFT + "rest_positions", lambda p: p / 4),
    "tetrahedron inverted": value(SOFT + "tetrahedra", lambda t: numpy.vstack([t[:1, [1, 0, 2, 3]], t[1:]])),
    "tetrahedron out of range": entry(SOFT + "tetrahedra", 5, LAST),
    "tetrahedron negative": entry(SOFT + "tetrahedra", 5, -1),
    "tetrahedron twice": value(SOFT + "tetrahedra", lambda t: numpy.vstack([t[1:2], t[1:]])),
    "regions exchanged": value(SOFT + "regions", lambda r: numpy.roll(r, 40)),
    "region unknown": entry(SOFT + "regions", 0, 9),
    "modulus zero": entry(SOFT + "materials", 0, 0.0),
    "modulus nan": entry(SOFT + "materials", 0, numpy.nan),
    "modulus 1e12": entry(SOFT + "materials", 0, 1e12),
    "moduli times 10": value(SOFT + "materials", lambda m: m * [10, 1]),
    "moduli a tenth": value(SOFT + "materials", lambda m: m * [0.1, 1]),
    "one modulus doubled": value(SOFT + "materials", lambda m: m * [[2, 1], [1, 1]]),
    "poisson 0.5": entry(SOFT + "materials", 1, 0.5),
    "poisson -1": entry(SOFT + "materials", 1, -1.0),
    "poisson 0": value(SOFT + "materials", lambda m: m * [1, 0]),
    "fixed node out of range": entry(SOFT + "fixed_nodes", -1, 10**6),
    "fixed nodes unsorted": value(SOFT + "fixed_nodes", lambda n: n[::-1]),
    "element order 3": attribute(SOFT, "element_order", to(3)),
    "element order 2": attribute(SOFT, "element_order", to(2)),
    "contact node out of range": entry(SOFT + "contact_nodes", -1, 10**6),
    "contact node negative": entry(SOFT + "contact_nodes", 0, -1),
    "contact nodes swapped": value(SOFT + "contact_nodes", lambda n: numpy.r_[n[1], n[0], n[2:]]),
    "contact nodes fewer": resized(SOFT + "contact_nodes", lambda nodes: nodes[:-1]),
    "surface triangle out of range": entry(SOFT + "surface_triangles", 0, LAST),
    "surface triangle negative": entry(SOFT + "surface_triangles", 0, -7),
    "surface turned inside out": value(SOFT + "surface_triangles", lambda t: t[:, ::-1]),
    "surface node out of range": entry(SOFT + "surface_nodes", -1, LAST),
    "another surface": value(SOFT + "surface_triangles", lambda t: numpy.roll(t, 1, axis=0)),
    # rigid bodies and trees
    "rigid vertex nan": entry(HARD + "vertices", 0, numpy.nan),
    "rigid vertex far": entry(HARD + "vertices", 0, 1e8),
    "rigid triangle out of range": entry(HARD + "triangles", 0, 10**6),
    "rigid triangle negative": entry(HARD + "triangles", 0, -1),
    "half of a rigid body inside out": value(HARD + "triangles", lambda t: numpy.vstack([t[: len(t) // 2, ::-1], t[len(t) // 2 :]])),
    "a rigid body inside out": value(HARD + "triangles", lambda t: t[:, ::-1].copy()),
    "a rigid body with a hole": value(HARD + "triangles", lambda t: numpy.vstack([t[1:2], t[1:]])),
    "a rigid body of points": value(HARD + "triangles", lambda t: t[:, [0, 0, 0]].copy()),
    "a rigid body left out of the row": lambda file: file.move(HARD[:-1], HARD[:-2] + "1"),
    "a lump next to no stiffness": entry(SOFT + "materials", 2, 1e-12),
    "a lump of a stiffness that overflows": entry(SOFT + "materials", 2, 1e-300),
    "wrong units": attribute("palpate", "units", to(b"m, N, s ")),
    "another frame": attribute("palpate", "space", to(b"RAS")),
    "bodies named by no text": attribute(HARD, "name", to(b"\xff\xfe\xed\xa0")),
    "a body named by a control": attribute(HARD, "name", to(b"s\xc2\x9b\x20")),
    "schema 99": attribute("palpate", "schema", to(99)),
    "schema 0": attribute("palpate", "schema", to(0)),
}
for body, part in ((SOFT, "soft"), (HARD, "rigid")):
    tree = body + "obb_tree/"
    PHYSICS |= {
        f"{part} tree: child to itself": entry(tree + "first", 0, 0),
        f"{part} tree: child out": entry(tree + "first", 0, LAST - 1),
        f"{part} tree: child negative": entry(tree + "first", 0, -1),
        f"{part} tree: count huge": entry(tree + "count", -1, LAST),
        f"{part} tree: count negative": entry(tree + "count", -1, -1),
        f"{part} tree: boxes shrunk": value(tree + "half_extents", lambda h: h * 0.5),
        f"{part} tree: one box shrunk": entry(tree + "half_extents", 0, 0.01),
        f"{part} tree: boxes of 100 m": value(tree + "half_extents", lambda h: h * 0 + 1e5),
        f"{part} tree: one box grown": entry(tree + "half_extents", 0, 60.0),
        f"{part} tree: box inside out": entry(tree + "half_extents", 0, -1.0),
        f"{part} tree: boxes moved": value(tree + "centers", lambda c: c + 1),
        f"{part} tree: center nan": entry(tree + "centers", 0, numpy.nan),
        f"{part} tree: axes nan": entry(tree + "axes", 0, numpy.nan),
        f"{part} tree: axes scaled": value(tree + "axes", lambda a: a * 3),
        f"{part} tree: order twice": entry(tree + "triangle_order", 0, 1),
    }
for setting in SETTINGS:
    PHYSICS |= {
        f"{setting} 1e9": attribute("palpate/haptics", setting, to(1e9)),
        f"{setting} nan": attribute("palpate/haptics", setting, to(numpy.nan)),
        f"{setting} infinite": attribute("palpate/haptics", setting, to(numpy.inf)),
        f"{setting} 0": attribute("palpate/haptics", setting, to(0.0)),
        f"{setting} negative": attribute("palpate/haptics", setting, to(-1.0)),
    }
for setting in ("friction_at_rest", "friction_sliding", "shaft_length", "grip"):
    PHYSICS |= {
        f"{setting} 1e9": attribute("palpate/haptics", setting, to(1e9)),
        f"{setting} negative": attribute("palpate/haptics", setting, to(-0.1)),
    }
DENSE = SOFT + "compliance/dense"
OF_DENSE = {
    "C times 2": value(DENSE, lambda c: c * 2),
    "C a half": value(DENSE, lambda c: c / 2),
    "C times -1": value(DENSE, lambda c: -c),
    "C zero": value(DENSE, lambda c: c * 0),
    "C entry nan": entry(DENSE, 100, numpy.nan),
    "C entry infinite": entry(DENSE, 100, numpy.inf),
    "C entry 1e30": entry(DENSE, 0, HUGE),
    "C stiff at a node": row_scaled(DENSE, slice(60, 63), 0.05),
    "C soft at a node": row_scaled(DENSE, slice(60, 63), 20),
    "C stiff and a soft spike": lambda file: (value(DENSE, lambda c: c / 3)(file), entry(SOFT + "materials", 2, 1e-6)(file)),
    "C times 2, incompressible": lambda file: (value(DENSE, lambda c: c * 2)(file),
                                               value(SOFT + "materials", lambda m: m * [1, 0] + [0, 0.5 - 1e-14])(file)),
    "C's diagonal alone": value(DENSE, lambda c: numpy.diag(numpy.diag(c))),
    "C of other nodes": value(DENSE, lambda c: numpy.roll(c, (3, 3), (0, 1))),
    "C of the mean": value(DENSE, lambda c: c * 0 + numpy.eye(len(c), dtype=c.dtype) * numpy.diag(c).mean()),
}
BLOCKS = SOFT + "compliance/"
OF_BLOCKS = {
    "C times 2": value(BLOCKS + "values", lambda v: v * 2),
    "C a half": value(BLOCKS + "values", lambda v: v / 2),
    "C zero": value(BLOCKS + "values", lambda v: v * 0),
    "C entry nan": entry(BLOCKS + "values", 40, numpy.nan),
    "C entry 1e30": entry(BLOCKS + "values", 0, HUGE),
    "C a half and coarse": lambda file: (attribute(BLOCKS, "accuracy", to(0.1))(file), value(BLOCKS + "values", lambda v: v / 2)(file)),
    "C's factors turned": value(BLOCKS + "factors", lambda f: f[::-1]),
    "C's factors full": value(BLOCKS + "factors", lambda f: f * 0 + 32767),
    "C's order turned": value(BLOCKS + "order", lambda o: o[::-1]),
    "C's order twice": entry(BLOCKS + "order", 0, 1),
    "C's depth 21": attribute(BLOCKS, "depth", to(21)),
    "C's depth negative": attribute(BLOCKS, "depth", to(-1)),
    "C's accuracy 1e9": attribute(BLOCKS, "accuracy", to(1e9)),
    "C's accuracy nan": attribute(BLOCKS, "accuracy", to(numpy.nan)),
    "C's block in itself": entry(BLOCKS + "first_child", 0, 0),
    "C's block out": entry(BLOCKS + "first_child", 0, LAST),
    "C's rank 1028": entry(BLOCKS + "rank", -1, 1028),
    "C's rank -2": entry(BLOCKS + "rank", -1, -2),
    "C's values out": entry(BLOCKS + "block_values", -1, 2**62),
    "C's values negative": entry(BLOCKS + "block_values", -1, -(2**62)),
    "C's factors out": value(BLOCKS + "block_factors", lambda f: f + 2**40),
}
# Nothing that is felt follows from these; what is said of it does.
CERTIFICATE = SOFT + "certificate"
CLAIMS = {
    "residual 0": attribute(CERTIFICATE, "residual", to(0.0)),
    "residual a tenth": attribute(CERTIFICATE, "residual", lambda r: r / 10),
    "load_error 0": attribute(CERTIFICATE, "load_error", to(0.0)),
    "contact_error 0": attribute(CERTIFICATE, "contact_error", to(0.0)),
    "more loads than tried": attribute(CERTIFICATE, "sampled_loads", to(LAST)),
    "more columns than tried": attribute(CERTIFICATE, "sampled_columns", to(LAST)),
    "finer than it is": attribute(CERTIFICATE, "free_dofs", lambda n: 10 * n),
    "smallest eigenvalue": attribute(CERTIFICATE, "smallest_eigenvalue", lambda e: 3 * e),
    "largest eigenvalue": attribute(CERTIFICATE, "largest_eigenvalue", lambda e: e / 3),
    "condition number": attribute(CERTIFICATE, "condition_number", to(1.0)),
    "patch eigenvalue": attribute(CERTIFICATE, "smallest_patch_eigenvalue", lambda e: 3 * e),
    "an error of the mesh that nobody estimated": attribute(CERTIFICATE, "discretisation_error", to(0.0)),
    "strain beyond what was tried": attribute(CERTIFICATE, "checked_strain", lambda strain: 2 * strain),
    "deeper than it was tried": attribute(CERTIFICATE, "checked_depth", lambda depth: 1.1 * depth),
    "a linear force that is right": attribute(CERTIFICATE, "linear_force_error", to(0.0)),
    "a linear surface that is right": attribute(CERTIFICATE, "linear_surface_error", to(0.0)),
    "pressed by another tool": attribute(SOFT + "feel", "tool_radius", to(4.0)),
    "pressed deeper": attribute(SOFT + "feel", "depth", to(6.0)),
    "a lump that nobody can feel, felt": attribute(SOFT + "feel/regions/0", "stiffness_without", lambda k: k / 2),
    "felt where it varies less": attribute(SOFT + "feel/regions/0", "variation", lambda v: v / 2),
    "felt at another depth": attribute(SOFT + "feel/regions/0", "depth", lambda d: d / 2),
    "felt twice as stiff": value(SOFT + "feel/stiffness", lambda k: k * 2),
    "positions without a unit": lambda file: file[SOFT + "rest_positions"].attrs.__delitem__("unit"),
    "an error of the mesh below none": attribute(CERTIFICATE, "discretisation_error", to(-0.5)),
    "positions in metres": attribute(SOFT + "rest_positions", "unit", lambda _: b"m"),
    "boxes in metres": attribute(HARD + "obb_tree/centers", "unit", lambda _: b"m"),
    "a picture in metres": attribute("VTKHDF/Points", "unit", lambda _: b"m"),
    "nothing beyond the surface": lambda file: resized(SOFT + "outside_labels", lambda l: numpy.full(len(file[SOFT + "rest_positions"]), -1, l.dtype))(file),
    "made by no JSON": lambda file: replace_text(file, "palpate/provenance", "{" * 9),
    "a picture of another version": attribute("VTKHDF", "Version", lambda _: [9, 9]),
    "another picture": entry("VTKHDF/Points", 0, 5.0),
    "another picture's regions": value("VTKHDF/CellData/region", lambda r: r * 0 + 1),
    "another picture's bodies": value("VTKHDF/CellData/body", lambda b: b[::-1]),
}


def write_ball(path, rings=6, sectors=12):
    """A rigid ball of as many triangles as a tree has more than one box for."""
    points = [(50.0, 15.0, 25.0), (50.0, 15.0, 5.0)]
    for ring in range(1, rings):
        for sector in range(sectors):
            tilt, turn = numpy.pi * ring / rings, 2 * numpy.pi * sector / sectors
            points.append((50 + 10 * numpy.sin(tilt) * numpy.cos(turn), 15 + 10 * numpy.sin(tilt) * numpy.sin(turn), 15 + 10 * numpy.cos(tilt)))
    at = lambda ring, sector: 2 + (ring - 1) * sectors + sector % sectors
    triangles = []
    for sector in range(sectors):
        triangles += [(0, at(1, sector), at(1, sector + 1)), (1, at(rings - 1, sector + 1), at(rings - 1, sector))]
        for ring in range(1, rings - 1):
            a, b, c, d = at(ring, sector), at(ring + 1, sector), at(ring + 1, sector + 1), at(ring, sector + 1)
            triangles += [(a, b, c), (a, c, d)]
    path.write_text(assets.grid("PolyData", points, "Polys", triangles))


class Forgeries(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(temporary.cleanup)
        cls.folder = pathlib.Path(temporary.name)
        for form in ("dense", "hierarchical"):
            cls.make(form)

    @classmethod
    def make(cls, form):
        """A block with a lump in it, beside a rigid tetrahedron."""
        parts = cls.folder
        assets.write_block(parts / "wall.vtu", n=5, edge=6.0)
        text = (parts / "wall.vtu").read_text()
        lumpy = " ".join("2" if 300 <= t < 330 else "1" for t in range(5 * 5**3))
        (parts / "wall.vtu").write_text(text.replace(" ".join(["1"] * 5 * 5**3), lumpy))
        write_ball(parts / "skull.vtp")
        for command in (["condense", parts / "wall.vtu", "--material", "1:5,0.45", "--material", "2:30,0.45", "--fixed",
                         "plane:0,0,1,0,0,-1", "--representation", form, "-o", parts / "wall.body.h5", "--force"],
                        ["obb", parts / "wall.vtu", "-o", parts / "wall.obb.h5", "--force"],
                        ["obb", parts / "skull.vtp", "-o", parts / "skull.obb.h5", "--force"],
                        ["pack", "--name", "case", "--rigid", f"skull={parts / 'skull.vtp'},{parts / 'skull.obb.h5'}",
                         "--deformable", f"wall={parts / 'wall.body.h5'},{parts / 'wall.obb.h5'}", "--tool-radius", 2,
                         "-o", parts / f"{form}.vtkhdf"]):
            made = run(BIN / f"palpate-{command[0]}", *command[1:], "--quiet")
            assert made.returncode == OK, made.stderr

    def forged(self, form, forge):
        path = self.folder / "forged.vtkhdf"
        shutil.copy(self.folder / f"{form}.vtkhdf", path)
        with h5py.File(path, "r+", libver=("v110", "v110")) as file:
            forge(file)
            rehash(file)
        return path

    def touch(self, path):
        log = self.folder / "log.csv"
        log.unlink(missing_ok=True)
        ran = run(BIN / "palpate-touch", path, "--script", "press", "--seconds", 0.2, "--virtual-clock", "--log", log, "--quiet")
        return ran, log.read_text() if log.exists() else None

    def assertRefused(self, form, forgeries):
        for name, forge in forgeries.items():
            with self.subTest(form=form, forged=name):
                path = self.forged(form, forge)
                touched, _ = self.touch(path)
                self.assertEqual(touched.returncode, INVALID, touched.stdout + touched.stderr)
                self.assertIn("forged.vtkhdf", touched.stderr)
                verified = run(BIN / "palpate-verify", path)
                self.assertIn(verified.returncode, (INVALID, QUALITY), verified.stdout + verified.stderr)

    def test_an_asset_that_was_not_changed_is_taken(self):
        for form in ("dense", "hierarchical"):
            path = self.forged(form, lambda file: None)
            self.assertEqual(self.touch(path)[0].returncode, OK)
            verified = run(BIN / "palpate-verify", path)
            self.assertEqual(verified.returncode, OK, verified.stdout + verified.stderr)

    def test_what_could_harm_a_hand_is_refused_by_touch_and_by_verify(self):
        self.assertRefused("dense", PHYSICS | OF_DENSE)

    def test_the_same_of_a_compressed_compliance(self):
        self.assertRefused("hierarchical", OF_BLOCKS)

    def test_what_is_only_claimed_is_refused_by_verify(self):
        reference = self.touch(self.forged("dense", lambda file: None))[1]
        forces = lambda log: [line.split(",")[:6] for line in log.splitlines()[1:]]
        for name, forge in CLAIMS.items():
            with self.subTest(claim=name):
                path = self.forged("dense", forge)
                touched, log = self.touch(path)
                if touched.returncode == OK:
                    self.assertEqual(forces(log), forces(reference))
                verified = run(BIN / "palpate-verify", path)
                self.assertIn(verified.returncode, (INVALID, QUALITY), verified.stdout + verified.stderr)

    def test_there_are_a_hundred_of_them(self):
        self.assertGreaterEqual(len(PHYSICS) + len(OF_DENSE) + len(OF_BLOCKS) + len(CLAIMS), 130)


class Twice(SampleAsset):
    """Honest values of a body that cannot be: two cubes in one place."""

    variant = ("twice",)

    def test_tissue_that_is_there_twice_is_refused_by_verify(self):
        verified = run(BIN / "palpate-verify", self.asset, "--json", self.folder / "verify.json")
        self.assertEqual(verified.returncode, QUALITY, verified.stdout + verified.stderr)
        (row,) = [row for row in json.loads((self.folder / "verify.json").read_text())["checks"] if "no part lies" in row["check"]]
        self.assertEqual((row["of"], row["status"]), ("wall", "failed"))
        for place, least, most in zip(row["figure"], (0, 0, 0), (26, 23, 20)):
            self.assertTrue(least <= place <= most, row)


if __name__ == "__main__":
    unittest.main()
