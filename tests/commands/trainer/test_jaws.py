# SPDX-License-Identifier: Apache-2.0
"""palpate train --instrument forceps: carried by keys and the mouse, closed by J, and the exercise that it serves."""
import math
import os
import subprocess
import sys
import tomllib
import unittest
from pathlib import Path

import h5py
import numpy as np

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from trainer_case import TrainerCase, is_whole, yellow_pixels  # noqa: E402

TOUCH = Path(os.environ["PALPATE_BIN"]) / "palpate-touch"
# About the sample's soft cube of 20 mm.
JAW, OPEN = 16, 120  # mm, degrees
FORCEPS = "--instrument", "forceps", "--jaw-length", JAW, "--jaw-radius", 1, "--jaw-opening", OPEN
BUTTON_ROW = 690  # pixels from the window's top
WAY_IN, WAY_BACK = 32, 10  # steps of half a millimetre; the first from the start, twice half a jaw's length outside
# Yellow pixels, at least: of a mark that is due, of the start page, of the page on which an exercise is made.
DUE, PAGE, EDITOR = 100, 1500, 4500


class ForcepsInTheWindow(TrainerCase):
    def open_forceps(self, *options):
        self.attempts, self.recording = self.folder / self.id(), self.folder / f"{self.id()}.h5"
        opened = self.open_window(*FORCEPS, "--attempts", self.attempts, "--record", self.recording, "--record-seconds", 30,
                                  "--force", *options)
        self.wait_for(lambda: self.recording.exists() and self.jaws() is not None)
        self.start, _, _ = self.jaws()
        return opened

    def press(self, key, times=1):
        self.x("xdotool", "key", *([key] * times))

    def jaws(self):
        """The place of the hinge (mm), the way out along the handle and the angle between the jaws (degrees) of the last tick."""
        with h5py.File(self.recording) as run:
            written = run["count/ticks"][0]
            if written < 16:
                return None
            rows = (written - 1 - np.arange(16)) % len(run["ticks/tool"])
            tool, tips, shafts = (run[f"ticks/{column}"][:][rows] for column in ("tool", "device_position", "shaft"))
        last = [np.argmax(tool == jaw) for jaw in (0, 1)]
        one, other = shafts[last]
        out = (one + other) / np.linalg.norm(one + other)
        return (tips[last] + JAW * shafts[last]).mean(axis=0), out, math.degrees(math.acos(np.clip(one @ other, -1, 1)))

    def wait_for_jaws(self, steps, opening):
        """Until the hand is so many steps in from its start, and its jaws are open by so many degrees."""
        def are_there():
            hinge, out, angle = self.jaws()
            return np.allclose(((self.start - hinge) @ out, angle), (steps / 2, opening), atol=0.1)

        self.wait_for(are_there)

    def wait_for_attempt(self):
        """Until an attempt has ended: if its hand repeats what it does, not by the first time that a starved servo lets it go."""
        self.wait_for(lambda: list(self.attempts.rglob("*.json")), 120)

    def wait_for_yellow(self, window, least, most=math.inf):
        self.wait_for(lambda: least <= yellow_pixels(self.screen(window)) < most)

    def leave_start_page(self, window):
        self.wait_for_yellow(window, PAGE)  # the first view is dark where others are bright beside the page
        self.press("BackSpace")
        self.wait_for_yellow(window, 0, DUE)

    def test_keys_take_hold_of_a_rim_hold_it_back_and_let_it_go(self):
        process, window = self.open_forceps("--exercise", "retract")
        self.press("Return")  # begin now
        self.press("w", WAY_IN)
        self.wait_for_jaws(WAY_IN, OPEN)
        self.press("j")
        self.wait_for_jaws(WAY_IN, 0)
        self.press("s", WAY_BACK)
        self.wait_for_yellow(window, 0, DUE)  # it is drawn, and has been kept
        self.press("j")
        self.wait_for_jaws(WAY_IN - WAY_BACK, OPEN)
        self.press("s", WAY_IN)
        self.wait_for_attempt()
        self.press("q")
        result = self.finish(process)
        (attempt,) = result["attempts"]
        self.assertEqual(attempt["exercise"]["task"], "retract")
        self.assertEqual(len(attempt["exercise"]["places_mm"]), 3)
        self.assertEqual(attempt["ending"], "all reached")
        self.assertEqual(attempt["metrics"]["goals"], 1)
        self.assertLess(attempt["metrics"]["position_error_mm"], 2)
        self.assertEqual(attempt["metrics"]["misses"], 0)
        self.assertGreater(result["force_peak_n"], 0.02)

    def test_a_hand_that_closes_nothing_holds_nothing_back(self):
        process, window = self.open_forceps("--exercise", "retract")
        self.press("Return")
        self.press("w", WAY_IN)
        self.wait_for_jaws(WAY_IN, OPEN)
        self.press("s", WAY_BACK)
        self.wait_for_jaws(WAY_IN - WAY_BACK, OPEN)
        self.press("q")
        (attempt,) = self.finish(process)["attempts"]
        self.assertEqual(attempt["ending"], "cut short")
        self.assertEqual(attempt["metrics"]["score"], 0)

    def test_a_teacher_sets_the_rim_that_is_held_and_where_it_is_drawn(self):
        file = self.folder / "made.toml"
        file.write_text('schema = 1\n[[exercise]]\nname = "back"\ntask = "retract"\n')
        process, window = self.open_forceps("--exercises", file)
        self.wait_for_yellow(window, PAGE)
        self.press("F2")  # a new one
        self.wait_for_yellow(window, EDITOR)
        self.press("space")  # to the organ
        self.wait_for_yellow(window, 0, DUE)
        self.press("m")  # nothing is held yet
        self.press("w", WAY_IN)
        self.wait_for_jaws(WAY_IN, OPEN)
        self.press("j")
        self.wait_for_jaws(WAY_IN, 0)
        self.press("m")
        self.wait_for_yellow(window, DUE)  # else it would be where the next keys have led the hand in the same frame
        self.press("s", WAY_BACK)
        self.wait_for_jaws(WAY_IN - WAY_BACK, 0)
        self.press("m")
        self.press("space")
        self.wait_for_yellow(window, EDITOR)
        self.press("s")
        self.wait_for(lambda: "retract-1" in file.read_text())
        self.press("BackSpace")
        self.wait_for_yellow(window, PAGE, EDITOR)
        self.press("q")
        self.finish(process)
        usual, made = tomllib.loads(file.read_text())["exercise"]
        self.assertEqual((usual["name"], made["name"], made["task"]), ("back", "retract-1", "retract"))
        rim, tips, there = made["places_mm"]
        self.assertAlmostEqual(math.dist(tips, there), 5, delta=1)  # ten steps, less what the tissue holds back
        self.assertAlmostEqual(math.dist(rim, tips), 8, delta=0.01)  # half a jaw

        process, _ = self.open_forceps("--exercises", file, "--exercise", "retract-1", "--script", "grasp")
        self.wait_for_attempt()
        self.press("q")
        (attempt,) = self.finish(process)["attempts"]
        self.assertEqual(attempt["ending"], "all reached")

    def test_a_drag_carries_it_and_the_pointer_alone_does_not(self):
        process, window = self.open_forceps()
        self.leave_start_page(window)
        self.x("xdotool", "mousemove", "--window", window, 640, 360)
        self.x("xdotool", "mousemove", "--window", window, 700, 300)
        self.come_to_rest()
        self.x("xdotool", "mousedown", 1)
        for _ in range(10):
            self.x("xdotool", "mousemove_relative", "--", 0, -12)
        self.x("xdotool", "mouseup", 1)
        self.come_to_rest()
        self.press("q")
        travel = self.finish(process)["device_travel_mm"]
        self.assertGreater(travel, 3)
        self.assertLess(travel, 100)

    def test_it_offers_the_exercises_that_it_serves_and_refuses_what_it_cannot_be(self):
        process, _ = self.open_forceps("--script", "grasp", "--exercise", "retract")
        self.wait_for_attempt()
        self.press("q")
        (attempt,) = self.finish(process)["attempts"]
        self.assertEqual(attempt["ending"], "all reached")
        path = self.folder / "retract.toml"
        path.write_text('schema = 1\n[[exercise]]\nname = "back"\ntask = "retract"\n')
        for options, code, message in (
            (("--exercises", path), 3, "--instrument forceps"),
            (("--script", "grasp"), 2, "--instrument forceps beside it"),
            ((*FORCEPS, "--script", "press"), 2, "grasp or a file"),
            ((*FORCEPS, "--second", path), 2, "--second: with --instrument forceps"),
        ):
            process = self.launch(*options, "--seconds", 1)
            _, err = process.communicate(timeout=60)
            self.assertEqual(process.returncode, code, err)
            self.assertIn(message, err)

    def test_a_recording_of_it_shows_one_forceps_whose_hand_feels_both_jaws(self):
        run = self.folder / "grasp.h5"
        touched = subprocess.run(
            [TOUCH, self.asset, *map(str, FORCEPS), "--virtual-clock", "--seconds", "3", "--depth", "2", "--record", run, "--json", "-"],
            capture_output=True, text=True, timeout=120)
        self.assertEqual(touched.returncode, 0, touched.stderr)
        with h5py.File(run) as file:
            written = file["count/ticks"][0]
            force, tool = file["ticks/force"][:written], file["ticks/tool"][:written]
        both = force[tool == 0] + force[tool == 1]
        # A film, which shows all of it however slowly it is drawn.
        film = "--pictures", self.folder / "grasp", "--film-rate", 10, "--size", "640x480"
        played = self.finish(self.launch("--play", run, *film))
        self.assertGreater(played["force_peak_n"], 0)
        self.assertLessEqual(played["force_peak_n"], max(math.hypot(*hand) for hand in both) + 1e-9)
        self.assertLess(played["force_peak_n"], 0.9 * max(math.hypot(*jaw) for jaw in force))  # they press against each other

    def test_a_language_of_longer_words_has_all_buttons_in_the_window(self):
        german = {**self.server.environment, "LC_ALL": "C.UTF-8", "LANGUAGE": "de"}
        process = self.launch(*FORCEPS, "--size", "1280x720", environment=german)  # most buttons
        window = self.find_window()
        self.leave_start_page(window)
        pictures = lambda: list(self.folder.glob("palpate-sample-*.png"))
        closed_at = None
        for x in range(1278, 1150, -8):  # from the edge until the last button, which closes the window, is hit
            subprocess.run(["xdotool", "mousemove", "--window", window, str(x), str(BUTTON_ROW), "click", "1", "key", "F12"],
                           env=self.server.environment, capture_output=True, timeout=60)
            # A window that has been closed draws no picture of what came after.
            self.wait_for(lambda: process.poll() is not None or any(map(is_whole, pictures())))
            if process.poll() is not None:
                closed_at = x
                break
            for picture in pictures():
                picture.unlink()
        self.assertIsNotNone(closed_at, "the last button is not in the window")
        self.assertLess(closed_at, 1280 - 16, "it reaches to the window's edge, or beyond")


if __name__ == "__main__":
    unittest.main()
