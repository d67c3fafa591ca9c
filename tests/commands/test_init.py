# SPDX-License-Identifier: GPL-3.0-or-later
"""palpate init: a scan or a label map becomes a case file that builds at once."""
import json
import os
import pathlib
import pty
import re
import select
import shutil
import subprocess
import sys
import tempfile
import time
import tomllib
import unittest

from drawn_out import draw_out
from x_server import NEEDED, XServer

BIN = pathlib.Path(os.environ["PALPATE_BIN"])
DATA = pathlib.Path(os.environ.get("PALPATE_DATA", ""))
SOURCE = pathlib.Path(os.environ["PALPATE_SOURCE"])
PHANTOM = pathlib.Path(os.environ["PALPATE_BUILD"]) / "tests" / "phantom"


def run(*arguments):
    environment = {name: value for name, value in os.environ.items() if name != "DISPLAY"}
    return subprocess.run(list(map(str, arguments)), text=True, capture_output=True, timeout=200, env=environment)


class Cases(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.temporary.cleanup)
        cls.folder = pathlib.Path(cls.temporary.name)
        cls.volume, cls.labels = cls.folder / "abdomen.nrrd", cls.folder / "truth.seg.nrrd"
        made = run(PHANTOM, "abdomen", cls.volume, cls.labels)
        assert made.returncode == 0, made.stderr

    def init(self, *arguments):
        return run(BIN / "palpate", "init", *arguments)

    def case(self, name, *arguments):
        path = self.folder / name
        made = self.init(*arguments, "-o", path, "--force")
        self.assertEqual(made.returncode, 0, made.stderr)
        return tomllib.loads(path.read_text())

    def assertBuilds(self, name):
        asset = (self.folder / name).with_suffix(".vtkhdf")
        built = run(BIN / "palpate", "build", self.folder / name, "-o", asset, "--force", "--virtual-clock")
        self.assertEqual(built.returncode, 0, built.stderr)
        seen = json.loads(run(BIN / "palpate", "inspect", asset, "--json", "-").stdout)
        return seen, asset.with_suffix(".html").read_text()


class Init(Cases):
    def test_a_label_map_becomes_an_organ_with_lesion_and_neighbour_that_builds(self):
        case = self.case("labels.toml", self.labels)
        self.assertEqual([region["label"] for region in case["deformable"][0]["region"]], ["liver", "tumour"])
        self.assertEqual(case["input"]["labels"], "truth.seg.nrrd")
        seen, report = self.assertBuilds("labels.toml")
        self.assertEqual({region["region"] for region in seen["regions"]}, {"liver", "tumour"})
        cautions = seen["provenance"]["build"]["cautions"]
        self.assertTrue(any("preset 'liver'" in caution for caution in cautions), cautions)
        self.assertIn("What that does not say", report)

    def test_a_liver_is_found_in_a_scan_from_one_seed_and_builds(self):
        where = json.loads(run(BIN / "palpate", "segment", "--labels", self.labels, "--structure",
                               "liver: recipe=import", "-o", self.folder / "l.seg.nrrd", "--json", "-",
                               "--force").stdout)["labels"][0]["centroid_mm"]
        seed = ",".join(f"{x:.1f}" for x in where)
        case = self.case("scan.toml", self.volume, "--organ", "liver", f"--seed={seed}")
        self.assertEqual(case["structure"][0]["recipe"], "liver")
        self.assertBuilds("scan.toml")

    # Real scans: one call of init, one of build, nothing written by hand.
    @unittest.skipUnless((DATA / "abdomen_ct_totalseg3mm").is_dir(), "PALPATE_DATA: abdomen_ct_totalseg3mm is absent")
    def test_an_organ_of_a_totalsegmentator_map_builds_and_can_be_drawn_out(self):
        self.case("kidney.toml", DATA / "abdomen_ct_totalseg3mm" / "seg_totalseg.nii.gz", "--organ", "kidney_left")
        seen, report = self.assertBuilds("kidney.toml")
        self.assertEqual(seen["name"], "kidney_left")
        self.assertIn("✓ Verified", report)
        drawn = draw_out(BIN, self.folder / "kidney.vtkhdf", self.folder, 20)  # where it folds between the jaws
        self.assertIsNone(drawn.lost)
        self.assertGreater(drawn.pull, 0.99 * drawn.most)
        self.assertLess(drawn.step, 0.03 * drawn.pull)

    @unittest.skipUnless((DATA / "head_mr_ch2").is_dir(), "PALPATE_DATA: head_mr_ch2 is absent")
    def test_a_brain_in_mri_builds_from_one_seed(self):
        case = self.case("brain.toml", DATA / "head_mr_ch2" / "ch2.nii.gz", "--organ", "brain", "--approach", "superior",
                         "--seed=25,40,30")
        self.assertEqual(case["structure"][0]["recipe"], "organ")
        seen, report = self.assertBuilds("brain.toml")
        self.assertTrue(1400 < seen["regions"][0]["volume_ml"] < 1900, seen["regions"])
        self.assertIn("✓ Verified", report)

    @unittest.skipUnless((DATA / "mesh_sofa").is_dir(), "PALPATE_DATA: mesh_sofa is absent")
    def test_what_a_surface_encloses_builds(self):
        case = self.case("surface.toml", DATA / "mesh_sofa" / "liver-smooth.obj", "--organ", "liver")
        self.assertEqual(case["input"]["labels"], "surface.seg.nrrd")
        seen, _ = self.assertBuilds("surface.toml")
        self.assertAlmostEqual(seen["regions"][0]["volume_ml"], 39.3, delta=0.2)

    def test_a_surface_with_a_hole_is_refused_by_place(self):
        hole = self.folder / "hole.obj"
        hole.write_text("v 0 0 0\nv 90 0 0\nv 0 90 0\nv 0 0 90\nf 1 3 2\nf 1 2 4\nf 1 4 3\n")
        made = self.init(hole, "-o", self.folder / "hole.toml")
        self.assertEqual(made.returncode, 3)
        self.assertIn("open edges", made.stderr)
        self.assertEqual(list(self.folder.glob("hole.*")), [hole])

    @unittest.skipUnless((DATA / "abdomen_ct_totalseg3mm").is_dir(), "PALPATE_DATA: abdomen_ct_totalseg3mm is absent")
    def test_any_organ_grows_against_seeds_around_it(self):
        case = self.case("kidney_seeds.toml", DATA / "abdomen_ct_totalseg3mm" / "ct.nii.gz", "--organ", "left kidney",
                         "--seed=85,-110,364", "--background-seed=60,-110,364", "--background-seed=85,-160,364")
        structure, = case["structure"]
        self.assertEqual(structure["recipe"], "grow-from-seeds")
        self.assertEqual(structure["background_mm"], [60, -110, 364, 85, -160, 364])
        self.assertEqual(case["deformable"][0]["name"], "left_kidney")

    def test_a_ct_in_eight_bits_gets_its_scale_and_builds(self):
        head, eight = self.folder / "head.nrrd", self.folder / "eight.nrrd"
        self.assertEqual(run(PHANTOM, "head", head, self.folder / "head.seg.nrrd", "--noise", 10).returncode, 0)
        self.assertEqual(run(BIN / "palpate", "import", head, "-o", eight, "--scale", 0.08, "--offset=85").returncode, 0)
        case = self.case("eight.toml", eight, "--organ", "nasopharynx", "--seed=0,-5,-40")
        self.assertAlmostEqual(case["input"]["scale"], 1 / 0.08, delta=0.04 / 0.08)
        self.assertAlmostEqual(case["input"]["offset"], -85 / 0.08, delta=40)
        self.assertBuilds("eight.toml")

    def test_what_is_missing_is_asked_for(self):
        for arguments, code, phrase in (
                ((self.volume, "-o", self.folder / "a.toml"), 2, "--seed"),
                ((self.volume, "--organ", "spleen", "-o", self.folder / "a.toml"), 2, "in the spleen"),
                ((self.volume, "--organ", "nasopharynx", "-o", self.folder / "a.toml"), 2, "behind the nose"),
                ((self.labels, "--organ", "lever", "-o", self.folder / "a.toml"), 3, "liver"),
                ((self.labels, "--approach", "up", "-o", self.folder / "a.toml"), 2, "anterior"),
                ((self.labels, "-o", self.folder / "a.txt"), 2, ".toml")):
            made = self.init(*arguments)
            self.assertEqual(made.returncode, code, made.stderr)
            self.assertIn(phrase, made.stderr)
            self.assertFalse((self.folder / "a.toml").exists())

    def test_a_file_that_is_there_is_kept(self):
        there = self.folder / "there.toml"
        there.write_text("mine")
        self.assertEqual(self.init(self.labels, "-o", there).returncode, 3)
        self.assertEqual(there.read_text(), "mine")


def pane_places(grid, window):
    """Where a window of that size (pixels) shows a place (LPS, mm) in its axial and its sagittal slice, at first: as
    tools/seeds/layout.cpp, for voxel axes that are the patient's."""
    status, gap, margin = 30, 2, 26
    wide, deep, tall = grid["extent_mm"]
    middle = [o + (e - h) / 2 for o, e, h in zip(grid["origin_mm"], grid["extent_mm"], grid["spacing_mm"])]
    width, height = window[0], window[1] - status

    def share(first, second):
        return min(max(first / (first + second), 0.42), 0.62)

    left, top = round(width * share(wide, deep)), round(height * share(deep, tall))
    panes = {"axial": (left, top, wide, deep), "coronal": (left, height - top, wide, tall),
             "sagittal": (width - left, height - top, deep, tall)}
    pixel = max(max(across / (w - gap - 2 * margin), down / (h - gap - 2 * margin)) for w, h, across, down in panes.values())
    return {"axial": lambda p: (round(left / 2 + (p[0] - middle[0]) / pixel), round(top / 2 + (p[1] - middle[1]) / pixel)),
            "sagittal": lambda p: (round(left + (width - left) / 2 + (p[1] - middle[1]) / pixel),
                                   round(top + (height - top) / 2 - (p[2] - middle[2]) / pixel))}


class Terminal:
    """A command at a terminal of its own, without a display: what it says there, and answers to its questions."""

    def __init__(self, *arguments):
        self.end, theirs = pty.openpty()
        environment = {name: value for name, value in os.environ.items() if name != "DISPLAY"}
        self.process = subprocess.Popen(list(map(str, arguments)), stdin=theirs, stderr=theirs, stdout=subprocess.PIPE, text=True,
                                        env=environment, start_new_session=True)
        os.close(theirs)
        self.said = ""

    def read(self, until, patience=60):
        """Reads on until that is said, and returns what came up to it."""
        deadline = time.monotonic() + patience
        while until not in self.said:
            left = deadline - time.monotonic()
            try:
                if left <= 0 or not select.select([self.end], [], [], left)[0]:
                    raise TimeoutError
                self.said += os.read(self.end, 4096).decode()
            except OSError as error:  # or it has ended
                raise AssertionError(f"not said: {until}\nbut {self.said}") from error
        before, self.said = self.said.split(until, 1)
        return before + until

    def answer(self, question, text):
        asked = self.read(question)
        os.write(self.end, (text + "\n").encode())
        return asked

    def finish(self):
        out, _ = self.process.communicate(timeout=200)
        os.close(self.end)
        return self.process.returncode, out


class InitTerminal(Cases):
    def start(self, *arguments):
        return Terminal(BIN / "palpate", "init", *arguments)

    def test_what_no_option_says_is_asked_and_the_same_comes_without_questions(self):
        path = self.folder / "asked.toml"
        terminal = self.start(self.labels, "-o", path)
        asked = terminal.answer("Which structure gives way under the tool? [liver]: ", "")
        self.assertRegex(asked, r"liver, \d+ ml\r\n")
        terminal.answer("Which side does the tool come from (anterior, posterior, left, right, superior, inferior)? [anterior]: ", "right")
        terminal.answer("[140]: ", "10")
        code, out = terminal.finish()
        self.assertEqual(code, 0)
        text = path.read_text()
        again = next(line for line in out.splitlines() if line.startswith("The same without questions: ")).split(": ", 1)[1]
        self.assertIn("--approach right --size-mib 10", again)
        path.unlink()
        made = run("sh", "-c", again.replace("palpate", str(BIN / "palpate"), 1))
        self.assertEqual(made.returncode, 0, made.stderr)
        self.assertEqual(path.read_text(), text)
        # The budget is kept, and used.
        self.assertBuilds("asked.toml")
        size = path.with_suffix(".vtkhdf").stat().st_size / 2**20
        self.assertTrue(3 < size < 11, size)

    def test_an_answer_that_makes_no_sense_is_told_and_asked_for_again(self):
        path = self.folder / "again.toml"
        terminal = self.start(self.labels, "-o", path)
        terminal.answer("[liver]: ", "livr")
        self.assertIn("liver", terminal.answer("[liver]: ", "liver"))
        terminal.answer("[anterior]: ", "up")
        self.assertIn("up", terminal.answer("[anterior]: ", ""))
        terminal.answer("[140]: ", "-3")
        self.assertIn("-3", terminal.answer("[140]: ", "20"))
        self.assertEqual(terminal.finish()[0], 0)
        self.assertTrue(path.exists())

    def test_a_scan_without_a_display_asks_for_a_point(self):
        path = self.folder / "point.toml"
        terminal = self.start(self.volume, "--approach", "anterior", "--contact-nodes", 400, "-o", path)
        terminal.answer("What gives way under the tool? [nasopharynx]: ", "liver")  # the phantom is as small as a head
        terminal.answer("A point x,y,z in the liver (LPS, mm): ", "here")
        terminal.answer("A point x,y,z in the liver (LPS, mm): ", "-30,-8,-4")
        self.assertEqual(terminal.finish()[0], 0)
        self.assertIn("-30", path.read_text())

    def test_nothing_is_asked_with_yes_and_an_end_of_the_input_leaves_nothing_behind(self):
        path = self.folder / "yes.toml"
        terminal = self.start(self.labels, "-o", path, "--yes")
        self.assertEqual(terminal.finish()[0], 0)
        self.assertTrue(path.exists())
        path = self.folder / "ended.toml"
        terminal = self.start(self.labels, "-o", path)
        terminal.answer("[liver]: ", "")
        terminal.read("[anterior]: ")
        os.write(terminal.end, b"\x04")
        self.assertEqual(terminal.finish()[0], 130)
        self.assertEqual(list(self.folder.glob("*ended*")), [])

    def test_of_several_series_one_is_asked_for_and_the_longest_is_proposed(self):
        head, both = self.folder / "head.nrrd", self.folder / "series"
        self.assertEqual(run(PHANTOM, "head", head, self.folder / "head.seg.nrrd").returncode, 0)
        slices = {}
        for volume in (self.volume, head):
            made = run(sys.executable, SOURCE / "sample_data" / "dicom_series.py", volume, both / volume.stem)
            self.assertEqual(made.returncode, 0, made.stderr)
            files = sorted((both / volume.stem).iterdir())
            if volume == head:
                files.pop().unlink()  # one slice less than the other
            slices[volume.stem] = len(files)
        path = self.folder / "series.toml"
        options = (both, "--organ", "liver", "--seed=-30,-8,-4", "--approach", "anterior", "--contact-nodes", 400, "-o", path)
        terminal = self.start(*options, "--yes")
        self.assertEqual(terminal.finish()[0], 3, "nobody says which")
        terminal = self.start(*options)
        listed = terminal.read("Which series? [")
        numbers = {int(count): number for number, count in re.findall(r"(\d+): CT .* x (\d+) voxels", listed)}
        self.assertEqual(set(numbers), set(slices.values()))
        proposed = terminal.read("]: ").removesuffix("]: ")
        self.assertEqual(proposed, numbers[max(slices.values())])
        os.write(terminal.end, f"{numbers[slices['abdomen']]}\n".encode())
        self.assertEqual(terminal.finish()[0], 0)
        self.assertEqual(tomllib.loads(path.read_text())["input"]["series"], numbers[slices["abdomen"]])


@unittest.skipUnless(all(map(shutil.which, NEEDED)), "PALPATE: xvfb, xdotool, x11-apps or imagemagick is missing")
class InitWindow(unittest.TestCase):
    """A scan and nothing else: one click, and what comes of it can be touched."""

    def x(self, *command):
        return subprocess.run([*map(str, command)], env=self.server.environment, check=True, capture_output=True, text=True,
                              timeout=60).stdout

    def click_and_save(self, scan, case, pane, place):
        """Runs init, clicks into a pane of its window, saves and leaves; what init said."""
        grid = json.loads(run(BIN / "palpate", "inspect", scan, "--json", "-").stdout)["grid"]
        init = subprocess.Popen([BIN / "palpate", "init", scan, "-o", case], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                text=True, env=self.server.environment)
        self.addCleanup(init.communicate)
        self.addCleanup(init.kill)
        window = self.x("xdotool", "search", "--sync", "--onlyvisible", "--name", "Palpate seeds").split()[0]
        self.x("xdotool", "windowfocus", "--sync", window)
        shape = dict(line.split("=") for line in self.x("xdotool", "getwindowgeometry", "--shell", window).splitlines())
        time.sleep(1)  # until it is drawn and listens
        pixels = pane_places(grid, (int(shape["WIDTH"]), int(shape["HEIGHT"])))[pane](place)
        self.x("xdotool", "mousemove", "--window", window, *pixels, "click", 1)
        self.x("xdotool", "key", "s")
        self.x("xdotool", "key", "q")
        _, said = init.communicate(timeout=60)
        self.assertEqual(init.returncode, 0, said)
        return said

    def assertFelt(self, case):
        """Builds at once, by the real clock, and pushes back; what inspect says of the asset."""
        asset = case.with_suffix(".vtkhdf")
        built = run(BIN / "palpate", "build", case, "-o", asset)
        self.assertEqual(built.returncode, 0, built.stderr)
        touched = run(BIN / "palpate", "touch", asset, "--virtual-clock", "--seconds", "3", "--json", "-", "--quiet")
        self.assertGreater(json.loads(touched.stdout)["force_peak_n"], 0.002)
        return json.loads(run(BIN / "palpate", "inspect", asset, "--json", "-").stdout)

    def setUp(self):
        self.server = XServer().__enter__()
        self.addCleanup(self.server.__exit__)
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    @unittest.skipUnless((DATA / "head_ct_headsq64").is_dir(), "PALPATE_DATA: head_ct_headsq64 is absent")
    def test_a_head_becomes_a_nasopharynx_by_one_click(self):
        case = self.folder / "head.toml"
        said = self.click_and_save(DATA / "head_ct_headsq64" / "head_ct_headsq64.mhd", case, "sagittal", (0, 110, 58.7))
        self.assertIn("nasopharynx is looked for", said)
        seen = self.assertFelt(case)
        self.assertTrue(any("soft-palate" in caution for caution in seen["provenance"]["build"]["cautions"]))

    @unittest.skipUnless((DATA / "abdomen_dicom_ts20").is_dir(), "PALPATE_DATA: abdomen_dicom_ts20 is absent")
    def test_a_dicom_folder_becomes_a_liver_by_one_click(self):
        case = self.folder / "abdomen.toml"
        said = self.click_and_save(DATA / "abdomen_dicom_ts20" / "dicom", case, "axial", (-76, -166, 0))
        self.assertIn("liver is looked for", said)
        self.assertEqual([region["region"] for region in self.assertFelt(case)["regions"]], ["liver"])
        self.assertIn("reaches the image’s edge", case.with_suffix(".html").read_text())  # the slab ends in the liver


if __name__ == "__main__":
    unittest.main()
