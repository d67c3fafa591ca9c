# SPDX-License-Identifier: GPL-3.0-or-later
"""palpate seeds under a real X server, driven with mouse and keyboard as a person would."""
import json
import os
import pathlib
import shutil
import subprocess
import tempfile
import time
import unittest

from x_server import NEEDED, XServer

BIN = pathlib.Path(os.environ["PALPATE_BIN"])
PHANTOM = pathlib.Path(os.environ["PALPATE_BUILD"]) / "tests" / "phantom"
DATA = pathlib.Path(os.environ.get("PALPATE_DATA", ""))

OK, FAILED, USAGE, INVALID = 0, 1, 2, 3
STATUS_HEIGHT, MARGIN = 30, 26  # pixels, as in tools/seeds/layout.cpp
PATIENCE = 60  # s: only a window that never answers takes this long


@unittest.skipUnless(all(map(shutil.which, NEEDED)), "PALPATE: xvfb, xdotool, x11-apps or imagemagick is missing")
class SeedsWindow(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.server = XServer().__enter__()
        cls.addClassCleanup(cls.server.__exit__)

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.output = self.folder / "liver.mrk.json"

    def x(self, *command):
        return subprocess.run([*map(str, command)], env=self.server.environment, check=True, capture_output=True,
                              timeout=PATIENCE).stdout

    def key(self, *names):
        for name in names:
            self.x("xdotool", "key", name)

    def click(self, place, button=1):
        self.x("xdotool", "mousemove", "--window", self.window, *place, "click", button)

    def run_seeds(self, *options, environment=None):
        return subprocess.run([BIN / "palpate-seeds", *map(str, options)], capture_output=True, text=True,
                              timeout=PATIENCE, env=environment or self.server.environment)

    def open_window(self, volume, *options):
        self.process = subprocess.Popen(
            [BIN / "palpate-seeds", volume, "-o", self.output, "--json", "-", *map(str, options)],
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=self.server.environment)
        self.addCleanup(self.process.communicate)
        self.addCleanup(self.process.kill)
        found = self.x("xdotool", "search", "--sync", "--onlyvisible", "--name", "Palpate seeds")
        self.window = found.split()[0].decode()
        self.x("xdotool", "windowfocus", "--sync", self.window)
        self.wait_for(lambda: len(set(self.pixels())) > 20)  # drawn

    def close_window(self):
        out, err = self.process.communicate(timeout=PATIENCE)
        self.assertEqual(self.process.returncode, OK, err)
        return json.loads(out), err

    def pixels(self):
        """The window on the screen as a list of (red, green, blue), rows from the top."""
        dump = self.x("xwd", "-silent", "-id", self.window)
        picture = subprocess.run(["convert", "xwd:-", "-depth", "8", "rgb:-"], input=dump, capture_output=True,
                                 check=True).stdout
        return list(zip(picture[0::3], picture[1::3], picture[2::3]))

    def orange(self, left, top, right, bottom):
        """How many pixels of a part of the window have the first label's hue."""
        width, _ = self.size()
        pixels = self.pixels()
        return sum(red > green + 8 > blue + 30 for y in range(top, bottom)
                   for red, green, blue in pixels[y * width + left:y * width + right])

    def size(self):
        lines = self.x("xdotool", "getwindowgeometry", "--shell", self.window).decode().splitlines()
        values = dict(line.split("=") for line in lines)
        return int(values["WIDTH"]), int(values["HEIGHT"])

    def wait_for(self, condition):
        end = time.monotonic() + PATIENCE
        while not condition():
            self.assertLess(time.monotonic(), end, "the window never showed what it should")
            time.sleep(0.05)


class OnPhantom(SeedsWindow):
    """A cube of 128 mm about the origin, so the panes are quarters of the window."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        made = tempfile.TemporaryDirectory()
        cls.addClassCleanup(made.cleanup)
        cls.volume = pathlib.Path(made.name) / "abdomen.nrrd"
        subprocess.run([PHANTOM, "abdomen", cls.volume, pathlib.Path(made.name) / "truth.seg.nrrd"], check=True,
                       capture_output=True)

    def axial(self, x, y):
        """Where the axial pane shows a place of the phantom (LPS, mm)."""
        width, height = self.size()
        middle = (height - STATUS_HEIGHT) / 4
        pixel = 128 / (2 * middle - 2 - 2 * MARGIN)
        return round(width / 4 + x / pixel), round(middle + y / pixel)

    def test_a_click_grows_the_region_in_three_slices_and_its_seed_segments_the_organ(self):
        self.open_window(self.volume)
        width, height = self.size()
        halves = [(0, 0, width // 2, height // 2 - 20), (0, height // 2, width // 2, height - 40),
                  (width // 2 + 4, height // 2, width, height - 40)]
        self.assertEqual([self.orange(*part) for part in halves], [0, 0, 0])
        place = self.axial(-20, 8)
        self.click(place)
        self.wait_for(lambda: all(self.orange(*part) > 1000 for part in halves))
        x, y = place
        self.assertGreater(self.orange(x - 20, y - 20, x + 20, y + 20), 800, "not grown about the click")
        self.key("s", "q")
        result, _ = self.close_window()
        self.assertEqual(result["schema"], "palpate.seeds/1")
        self.assertTrue(result["saved"])
        self.assertEqual(result["growths"], 1)
        self.assertGreater(result["last_growth_seconds"], 0)
        self.assertEqual(len(result["seeds"]), 1)
        self.assertEqual(result["seeds"][0]["label"], "liver", "the output's name is the label")
        for value, expected in zip(result["seeds"][0]["position_mm"], (-20, 8, 1)):
            self.assertAlmostEqual(value, expected, delta=1)  # a pixel is 0.4 mm, slices are 2 mm apart
        point, = json.loads(self.output.read_text())["markups"][0]["controlPoints"]
        self.assertEqual(point["position"], result["seeds"][0]["position_mm"])

        labels = self.folder / "labels.seg.nrrd"
        segmented = subprocess.run(
            [BIN / "palpate-segment", "--volume", self.volume, "--structure",
             f"liver: recipe=grow-from-seeds seeds_file={self.output}", "-o", labels, "--json", "-"],
            capture_output=True, text=True, timeout=PATIENCE)
        self.assertEqual(segmented.returncode, OK, segmented.stderr)
        grown, = json.loads(segmented.stdout)["labels"]
        region, = result["regions"]
        self.assertEqual(region["name"], "liver")
        self.assertGreater(grown["volume_ml"], 30)
        self.assertAlmostEqual(region["volume_ml"], grown["volume_ml"], delta=0.1 * grown["volume_ml"])

    def test_labels_removal_undo_scrolling_and_the_crosshair(self):
        self.open_window(self.volume, "--label", "liver", "--label", "spine")
        self.click(self.axial(-20, 8))
        self.key("0")
        self.click(self.axial(30, 0))
        self.click(self.axial(30, 1), 3)  # removed
        self.key("u")  # and back
        self.key("2")
        self.click(self.axial(-40, -40))
        self.key("x")
        self.click(self.axial(0, 40), 4)  # three slices towards the head
        self.click(self.axial(0, 40), 4)
        self.click(self.axial(0, 40), 4)
        self.click(self.axial(20, 20), 2)  # the crosshair only
        self.click(self.axial(0, 40))
        width, height = self.size()
        self.click((width * 3 // 4, height // 4))  # the legend: no place
        self.key("s", "q")
        result, _ = self.close_window()
        self.assertEqual([seed["label"] for seed in result["seeds"]], ["liver", "background", "spine"])
        heights = [seed["position_mm"][2] for seed in result["seeds"]]
        self.assertEqual([round(height - heights[0]) for height in heights], [0, 0, 6])
        self.assertEqual([region["name"] for region in result["regions"]], ["liver", "spine"])

    def test_unsaved_seeds_need_a_second_q_and_leave_no_file(self):
        self.open_window(self.volume)
        self.click(self.axial(-20, 8))
        self.key("q")
        time.sleep(0.5)
        self.assertIsNone(self.process.poll(), "closed without asking")
        self.key("q")
        result, err = self.close_window()
        self.assertFalse(result["saved"])
        self.assertIn("without saving", err)
        self.assertEqual(list(self.folder.iterdir()), [])

    def test_seeds_of_a_file_grow_at_once_and_are_gone_on_with(self):
        self.open_window(self.volume)
        self.click(self.axial(-20, 8))
        self.key("s", "q")
        first, _ = self.close_window()
        refused = self.run_seeds(self.volume, "-o", self.output)
        self.assertEqual(refused.returncode, INVALID)
        self.assertIn("--force", refused.stderr)
        self.open_window(self.volume, "--seeds", self.output, "--force")
        self.wait_for(lambda: self.orange(0, 0, *[half // 2 for half in self.size()]) > 1000)
        self.key("0")
        self.click(self.axial(30, 0))
        self.key("s", "q")
        second, _ = self.close_window()
        self.assertEqual(second["seeds"][0], first["seeds"][0])
        self.assertEqual(second["seeds"][1]["label"], "background")
        self.assertEqual(len(json.loads(self.output.read_text())["markups"][0]["controlPoints"]), 2)

    def test_bad_arguments_are_refused(self):
        outside = self.folder / "outside.mrk.json"
        outside.write_text(json.dumps({"markups": [{"coordinateSystem": "LPS", "controlPoints": [
            {"label": "liver", "position": [1000, 0, 0]}]}]}))
        cases = [
            ([self.volume, "-o", self.folder / "liver.txt"], USAGE, ".mrk.json"),
            ([self.volume, "-o", self.output, "--window-level", "0,40"], USAGE, "--window-level"),
            ([self.volume, "-o", self.output] + [f"--label={letter}" for letter in "abcdefghij"], USAGE, "9 or fewer"),
            ([self.volume, "-o", self.output, "--label", ""], USAGE, "--label"),
            ([self.volume, "-o", self.folder / "none" / "a.mrk.json"], INVALID, "folder does not exist"),
            ([self.volume, "-o", self.output, "--seeds", outside], INVALID, "liver"),
            ([self.folder / "nothing.nrrd"], INVALID, "nothing.nrrd"),
        ]
        for options, code, words in cases:
            run = self.run_seeds(*options)
            self.assertEqual(run.returncode, code, run.stderr)
            self.assertIn(words, run.stderr)

    def test_without_a_display_the_remedy_is_named(self):
        for display in ({}, {"DISPLAY": ":9999"}):
            environment = {k: v for k, v in os.environ.items() if k != "DISPLAY"} | display
            run = self.run_seeds("--window-level", "400,-40", "--label", "liver", self.volume, "-o", self.output,
                                 environment=environment)
            self.assertEqual(run.returncode, FAILED)
            self.assertIn("3D Slicer", run.stderr)


@unittest.skipUnless((DATA / "abdomen_ct_spl").is_dir(), "PALPATE_DATA: abdomen_ct_spl is absent")
class OnRealAbdomen(SeedsWindow):
    volume = DATA / "abdomen_ct_spl" / "ct.nrrd"

    def test_the_liver_is_at_the_left_of_the_axial_slice_and_grows_from_a_click(self):
        self.open_window(self.volume)
        width, height = self.size()
        place = round(width * 0.18), round((height - STATUS_HEIGHT) * 0.29)
        self.click(place)
        x, y = place
        self.wait_for(lambda: self.orange(x - 20, y - 20, x + 20, y + 20) > 800)
        self.key("s", "q")
        result, _ = self.close_window()
        self.assertLess(result["seeds"][0]["position_mm"][0], -50, "the patient's right")
        self.assertGreater(result["regions"][0]["volume_ml"], 300)
        segmented = subprocess.run(
            [BIN / "palpate-segment", "--volume", self.volume, "--structure",
             f"liver: recipe=liver seeds_file={self.output}", "-o", self.folder / "labels.seg.nrrd", "--json", "-"],
            capture_output=True, text=True, timeout=2 * PATIENCE)
        self.assertEqual(segmented.returncode, OK, segmented.stderr)
        liver, = json.loads(segmented.stdout)["labels"]
        self.assertGreater(liver["volume_ml"], 300)
        self.assertLess(liver["centroid_mm"][0], 0)


if __name__ == "__main__":
    unittest.main()
