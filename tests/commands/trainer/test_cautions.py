# SPDX-License-Identifier: Apache-2.0
"""How a case was made, as palpate-train's window says it until something is touched and whenever I is pressed."""

import unittest

import numpy as np

from trainer_case import TrainerCase

ABOUT = slice(56, 300), slice(1030, 1262)  # rows and columns in which it is told, beside notices
LINE = 18  # pixels from one to the next, at least
NOTES = [
    "The skull is a ball of 15 mm that no scan shows: place and size of it are made up.",
    "The scan's values rise along each axis and stand for no tissue.",
]


class Cautions(TrainerCase):
    variant = ("noted",)

    def written(self):
        """Pixels of letters there, and how many rows of pixels they take."""
        letters = self.scene()[ABOUT].min(axis=2) > 180
        rows = np.flatnonzero(letters.any(axis=1))
        return int(letters.sum()), int(np.ptp(rows)) if len(rows) else 0

    def test_they_are_told_until_something_is_touched_and_when_i_is_pressed(self):
        process, window = self.open_window()
        self.leave_start_page(window)
        letters, height = self.written()
        self.assertGreater(letters, 300)
        self.assertGreater(height, 2 * LINE)  # the first one takes two lines, the other one
        self.assertLess(height, 4 * LINE)
        self.x("xdotool", "key", "--repeat", 20, "w")  # half a millimetre each, from 5 mm above the surface
        self.come_to_rest()
        self.assertEqual(self.written(), (0, 0))
        self.x("xdotool", "key", "i")
        self.assertEqual(self.written()[1], height)
        self.x("xdotool", "key", "i")
        self.assertEqual(self.written(), (0, 0))
        self.x("xdotool", "key", "q")
        result = self.finish(process)
        self.assertGreater(result["force_peak_n"], 0)
        self.assertEqual(result["cautions"], NOTES)


if __name__ == "__main__":
    unittest.main()
