# SPDX-License-Identifier: Apache-2.0
"""palpate train --instrument forceps: carried by keys and the mouse, closed by J, and the exercise that it serves."""
import math
import os
import subprocess
import sys
import time
import tomllib
import unittest
from pathlib import Path

import h5py

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from trainer_case import TrainerCase  # noqa: E402

TOUCH = Path(os.environ["PALPATE_BIN"]) / "palpate-touch"
# About the sample's soft cube of 20 mm.
FORCEPS = "--instrument", "forceps", "--jaw-length", 16, "--jaw-radius", 1, "--jaw-opening", 120
BUTTON_ROW = 690  # pixels from the window's top
WAY_IN = 32  # steps of half a millimetre from the start, twice half a jaw's length outside


class ForcepsInTheWindow(TrainerCase):
    def open_forceps(self, *options):
        return self.open_window(*FORCEPS, "--attempts", self.folder / self.id(), *options)

    def press(self, key, times=1):
        self.x("xdotool", "key", *([key] * times))

    def test_keys_take_hold_of_a_rim_hold_it_back_and_let_it_go(self):
        process, window = self.open_forceps("--exercise", "retract")
        self.press("Return")  # begin now
        self.press("w", WAY_IN)
        self.come_to_rest()
        self.press("j")
        time.sleep(2.5)  # from 120 degrees, a radian a second
        self.press("s", 10)
        time.sleep(2)
        self.come_to_rest()
        self.press("j")
        time.sleep(2.5)
        self.press("s", WAY_IN)
        self.come_to_rest()
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
        self.press("s", 10)
        self.come_to_rest()
        self.press("q")
        (attempt,) = self.finish(process)["attempts"]
        self.assertEqual(attempt["ending"], "cut short")
        self.assertEqual(attempt["metrics"]["score"], 0)

    def test_a_teacher_sets_the_rim_that_is_held_and_where_it_is_drawn(self):
        file = self.folder / "made.toml"
        file.write_text('schema = 1\n[[exercise]]\nname = "back"\ntask = "retract"\n')
        process, window = self.open_forceps("--exercises", file)
        self.wait_for(lambda: self.shows_page(window))
        for key in ("F2", "space"):  # a new one; to the organ
            self.press(key)
            time.sleep(0.5)
        self.press("m")  # nothing is held yet
        self.press("w", WAY_IN)
        self.come_to_rest()
        self.press("j")
        time.sleep(2.5)
        self.press("m")
        self.press("s", 10)
        self.come_to_rest()
        for key in ("m", "space", "s", "BackSpace", "q"):
            self.press(key)
            time.sleep(0.5)
        self.finish(process)
        usual, made = tomllib.loads(file.read_text())["exercise"]
        self.assertEqual((usual["name"], made["name"], made["task"]), ("back", "retract-1", "retract"))
        rim, tips, there = made["places_mm"]
        self.assertAlmostEqual(math.dist(tips, there), 5, delta=1)  # ten steps, less what the tissue holds back
        self.assertAlmostEqual(math.dist(rim, tips), 8, delta=0.01)  # half a jaw

        process, _ = self.open_forceps("--exercises", file, "--exercise", "retract-1", "--script", "grasp", "--seconds", 6)
        (attempt,) = self.finish(process)["attempts"]
        self.assertEqual(attempt["ending"], "all reached")

    def test_a_drag_carries_it_and_the_pointer_alone_does_not(self):
        process, window = self.open_forceps()
        self.wait_for(lambda: self.shows_page(window))
        self.press("BackSpace")
        time.sleep(1)
        self.x("xdotool", "mousemove", "--window", window, 640, 360)
        self.x("xdotool", "mousemove", "--window", window, 700, 300)
        self.come_to_rest()
        self.x("xdotool", "mousedown", 1)
        for _ in range(10):
            self.x("xdotool", "mousemove_relative", "--", 0, -12)
            time.sleep(0.05)
        self.x("xdotool", "mouseup", 1)
        self.come_to_rest()
        self.press("q")
        travel = self.finish(process)["device_travel_mm"]
        self.assertGreater(travel, 3)
        self.assertLess(travel, 100)

    def test_it_offers_the_exercises_that_it_serves_and_refuses_what_it_cannot_be(self):
        process, window = self.open_forceps("--script", "grasp", "--exercise", "retract", "--seconds", 6)
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
        played = self.finish(self.launch("--play", run, "--speed", 4, "--seconds", 1))
        self.assertGreater(played["force_peak_n"], 0)
        self.assertLessEqual(played["force_peak_n"], max(math.hypot(*hand) for hand in both) + 1e-9)
        self.assertLess(played["force_peak_n"], 0.9 * max(math.hypot(*jaw) for jaw in force))  # they press against each other

    def test_a_language_of_longer_words_has_all_buttons_in_the_window(self):
        german = {**self.server.environment, "LC_ALL": "C.UTF-8", "LANGUAGE": "de"}
        process = self.launch(*FORCEPS, "--size", "1280x720", environment=german)  # most buttons
        window = self.find_window()
        self.wait_for(lambda: self.shows_page(window))
        self.x("xdotool", "key", "BackSpace")
        self.come_to_rest()
        closed_at = None
        for x in range(1278, 1150, -8):  # from the edge until the last button, which closes the window, is hit
            subprocess.run(["xdotool", "mousemove", "--window", window, str(x), str(BUTTON_ROW), "click", "1"],
                           env=self.server.environment, capture_output=True, timeout=60)
            try:
                process.wait(timeout=1)
                closed_at = x
                break
            except subprocess.TimeoutExpired:
                continue
        self.assertIsNotNone(closed_at, "the last button is not in the window")
        self.assertLess(closed_at, 1280 - 16, "it reaches to the window's edge, or beyond")


if __name__ == "__main__":
    unittest.main()
