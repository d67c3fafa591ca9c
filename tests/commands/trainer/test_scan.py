# SPDX-License-Identifier: Apache-2.0
"""The scan in the trainer's window: slices through the tool, and what a cut lays open."""

import subprocess
import time
import unittest

import numpy as np

from trainer_case import TrainerCase

BONE_INSIDE = 158, 148, 126  # (r, g, b): 0.7 of how bone is coloured


class ScanInTheWindow(TrainerCase):
    def open_window(self):
        process, window = super().open_window()
        self.leave_start_page(window)
        self.x("xdotool", "key", "h")  # hints fade by themselves
        return process, window

    def press(self, key):
        self.x("xdotool", "key", key)
        time.sleep(0.8)

    def close(self, process):
        self.x("xdotool", "key", "q")
        return self.finish(process)

    def scene(self, window):
        """The pixels between texts and buttons, as (r, g, b), but for the scale at the right."""
        return self.pixels_in(window, "1140x500+0+120")

    def pixels_in(self, window, part):
        rgb = subprocess.run(["convert", "xwd:-", "-crop", part, "+repage", "-depth", "8", "rgb:-"],
                             input=self.screen(window), capture_output=True, check=True).stdout
        return list(zip(rgb[0::3], rgb[1::3], rgb[2::3]))

    def scale(self, window):
        """Whether a bar from white above to black below says what the greys mean."""
        column = self.pixels_in(window, "1x220+1180+345")
        return all(r == g == b for r, g, b in column) and column == sorted(column, reverse=True) and column[0][0] - column[-1][0] > 200

    def greys(self, window):
        return [r for r, g, b in self.scene(window) if r == g == b]

    def test_x_goes_through_the_slices_whose_greys_are_the_scans(self):
        process, window = self.open_window()
        before = len(self.greys(window))
        self.assertFalse(self.scale(window))
        for plane in ("axial", "coronal", "sagittal"):
            self.press("x")
            greys = self.greys(window)
            with self.subTest(plane):
                self.assertGreater(len(greys), before + 2000)
                self.assertGreater(len(set(greys)), 25)  # the scan's values rise all over
                self.assertTrue(self.scale(window))
        self.press("x")
        self.assertFalse(self.scale(window))
        self.assertLess(len(self.greys(window)), before + 200)
        self.close(process)

    def test_c_lays_bone_open_in_one_colour_where_there_is_no_scan_of_it(self):
        hand = self.folder / "still.txt"  # the cut goes with the tool
        hand.write_text("0 40 10 28\n1000 40 10 28\n")
        process = self.launch("--body", "skull", "--target", "40,10,25", "--script", hand)
        self.find_window()
        for command in (("mousemove", 640, 500), ("mousedown", 3), *([("mousemove_relative", "--", 0, -20)] * 10), ("mouseup", 3)):
            self.x("xdotool", *command)  # to look from the side, so that half of the ball stands before the tool
        opened = lambda: int((np.abs(TrainerCase.scene(self) - BONE_INSIDE).max(axis=2) <= 1).sum())
        self.come_to_rest()
        before = opened()
        self.press("c")
        self.come_to_rest()
        cut = opened()
        self.assertGreater(cut, before + 20000)  # pixels; light makes no two of a surface alike
        self.press("b")
        self.assertLess(opened(), cut / 10)
        self.press("b")
        self.assertGreater(opened(), 0.9 * cut)
        self.press("v")  # the tip's view cuts nothing
        self.assertLess(opened(), cut / 10)
        self.close(process)


if __name__ == "__main__":
    unittest.main()
