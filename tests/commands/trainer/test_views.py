# SPDX-License-Identifier: Apache-2.0
"""Views of palpate-train in a real window: the endoscope, whole and in a corner, and how much is drawn."""

import time
import unittest

from trainer_case import OpenedTrainer, pixels

BESIDE_THE_CIRCLE, IN_THE_CIRCLE = (1240, 690), (640, 360)  # of an endoscope that fills 1280x720 pixels
# Of one in the window's corner: 360 pixels wide, 22 from the right edge and 72 from below.
CORNER_OF_THE_CORNER, MIDDLE_OF_THE_CORNER = (903, 294), (1078, 468)
BLACK = (0, 0, 0)
DETAIL = 50  # of a channel's 255: what grain and edges may change of a pixel where more or less is drawn


class Views(OpenedTrainer):
    def press(self, *keys):
        for key in keys:
            self.x("xdotool", "key", key)
        time.sleep(1)

    def pixels(self, window, *places):
        """Red, green and blue of the window's pixels."""
        rgb = pixels(self.screen(window))
        self.assertEqual(len(rgb), 3 * 1280 * 720)
        return [tuple(rgb[3 * (1280 * y + x) :][:3]) for x, y in places]

    def assertAlike(self, pixels, others):
        for pixel, other in zip(pixels, others, strict=True):
            for a, b in zip(pixel, other):
                self.assertAlmostEqual(a, b, delta=DETAIL)

    def test_v_shows_the_tip_s_view_whole_then_in_a_corner_then_not(self):
        process, window = self.open_window()
        places = BESIDE_THE_CIRCLE, CORNER_OF_THE_CORNER, MIDDLE_OF_THE_CORNER
        outside = self.pixels(window, *places)
        self.assertNotIn(BLACK, outside)
        self.press("v")
        self.assertEqual(self.pixels(window, BESIDE_THE_CIRCLE), [BLACK])
        self.press("v")
        beside, corner, middle = self.pixels(window, *places)
        self.assertAlike([beside], outside[:1])
        self.assertEqual(corner, BLACK)
        self.assertNotEqual(middle, BLACK)
        self.press("v")
        self.assertAlike(self.pixels(window, *places), outside)
        self.close(process)

    def test_the_tip_s_light_grows_fainter_with_distance(self):
        process, window = self.open_window()
        self.press("v")  # looks where the view looked: at the organ
        (near,) = self.pixels(window, IN_THE_CIRCLE)
        self.press(*40 * ["s"])  # half a millimetre each, straight back
        (far,) = self.pixels(window, IN_THE_CIRCLE)
        self.close(process)
        self.assertGreater(sum(far), 30)
        self.assertLess(sum(far), 0.85 * sum(near))

    def test_r_leaves_the_endoscope(self):
        process, window = self.open_window()
        outside = self.pixels(window, BESIDE_THE_CIRCLE, CORNER_OF_THE_CORNER)
        for times in (1, 2):
            self.press(*times * ["v"], "r")
            self.assertAlike(self.pixels(window, BESIDE_THE_CIRCLE, CORNER_OF_THE_CORNER), outside)
        self.close(process)

    def test_how_much_is_drawn_is_told(self):
        process, _ = self.open_window()
        detail = self.close(process)["detail"]
        self.assertGreaterEqual(detail["level"], 1)
        self.assertLessEqual(detail["level"], detail["levels"])
        self.assertGreaterEqual(detail["changes"], detail["levels"] != detail["level"])


if __name__ == "__main__":
    unittest.main()
