# SPDX-License-Identifier: Apache-2.0
"""The trainer's buttons and keys, in a real window of 1280x720 pixels."""

import json
import subprocess
import time
import unittest

from trainer_case import TRAIN, OpenedTrainer, difference, yellow_pixels

BUTTON_ROW = 690  # pixels from the window's top


class Controls(OpenedTrainer):
    def click(self, window, x, y=BUTTON_ROW):
        self.x("xdotool", "mousemove", "--window", window, x, y, "click", 1)
        time.sleep(0.6)

    def test_a_button_does_what_its_key_does_and_touches_nothing(self):
        process, window = self.open_window()
        inside = 195  # where its button lies
        before = yellow_pixels(self.screen(window))
        for shown in (True, False):
            self.click(window, inside)
            self.x("xdotool", "mousemove", "--window", window, 150, 300)
            self.wait_for(lambda: (yellow_pixels(self.screen(window)) > before + 500) == shown)
        self.x("xdotool", "key", "q")
        self.assertEqual(self.finish(process)["force_peak_n"], 0)

    def test_u_takes_a_change_of_the_view_back(self):
        process, _ = self.open_window()
        before = self.come_to_rest()
        self.x("xdotool", "mousedown", 3, "mousemove_relative", 60, 30, "mouseup", 3)
        turned = self.come_to_rest()
        self.assertGreater(difference(before, turned), 5)
        self.x("xdotool", "key", "u")
        # Not to the bit: what detail there is time for may have changed meanwhile.
        self.assertLess(difference(before, self.come_to_rest()), 0.3 * difference(before, turned))
        self.x("xdotool", "key", "q")
        self.finish(process)

    def test_a_recording_begun_and_ended_by_a_key_replays(self):
        process, _ = self.open_window()
        self.x("xdotool", "key", "o")
        self.wait_for((self.folder / "palpate-sample-1.h5").exists)  # a replay starts from before the contact
        for _ in range(20):  # half a millimetre each, from 5 mm above the surface
            self.x("xdotool", "key", "w")
        self.come_to_rest()
        self.x("xdotool", "key", "o")
        self.picture()
        self.x("xdotool", "key", "q")
        result = self.finish(process)
        self.assertEqual(result["recorded_by_key"], ["palpate-sample-1.h5"])
        self.assertNotIn("recording", result)
        touch = subprocess.run(
            [TRAIN.with_name("palpate-touch"), self.asset, "--replay", self.folder / "palpate-sample-1.h5",
             "--json", "-"], capture_output=True, text=True, timeout=60)
        self.assertEqual(touch.returncode, 0, touch.stderr)
        replay = json.loads(touch.stdout)
        self.assertEqual(replay["replay"]["different_ticks"], 0)
        self.assertGreater(replay["replay"]["ticks"], 300)
        self.assertGreater(replay["force_peak_n"], 0.01)
        self.assertLessEqual(replay["force_peak_n"], result["force_peak_n"])

    def test_f_takes_the_next_contact_scheme_and_the_tool_is_felt_with_it(self):
        process, _ = self.open_window()
        self.x("xdotool", "key", "o")
        self.x("xdotool", "key", "f")  # of 'continuous', the last one, the next is the first
        self.come_to_rest()
        for _ in range(20):  # half a millimetre each, from 5 mm above the surface
            self.x("xdotool", "key", "w")
        self.come_to_rest()
        self.x("xdotool", "key", "q")
        result = self.finish(process)
        self.assertEqual(result["scheme"], "single")
        self.assertGreater(result["force_peak_n"], 0.01)
        self.assertNotIn("recording", result, "a recording is of one scheme")


if __name__ == "__main__":
    unittest.main()
