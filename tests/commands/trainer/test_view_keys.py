# SPDX-License-Identifier: Apache-2.0
"""What changes palpate-train's view and not where its tool is, in a real window: zoom, bones, cut, stiffness."""

import unittest

import numpy as np

from trainer_case import OpenedTrainer

ZOOMED = 1.15**4  # times as large: four steps
STEPPED = 0.02  # of a length on the screen: what a step of 15 % is told from
SCENE = slice(180, 600)  # rows between texts, with what is told of a starved servo, and buttons
SEEN = 200  # pixels: more than an edge leaves


def tissue(scene):
    r, g, b = np.moveaxis(scene, -1, 0)
    return (g >= r) & (g > b + 20)


def bone(scene):
    r, g, b = np.moveaxis(scene, -1, 0)
    return (r > g + 3) & (g > b + 5)


def tool(scene):
    """Its ball, which is blue."""
    r, g, b = np.moveaxis(scene, -1, 0)
    return (b > g + 20) & (g > r + 20)


class ViewOfOrgan(OpenedTrainer):
    def seen(self):
        """How many pixels between texts and buttons are bone, tissue, tool, and where the tool is, pixels from the left."""
        scene = self.scene()[SCENE]
        places = np.nonzero(tool(scene))[1]
        return int(bone(scene).sum()), int(tissue(scene).sum()), len(places), float(places.mean()) if len(places) else None


class ViewKeys(ViewOfOrgan):
    def test_wheel_keys_and_ctrl_drag_zoom_by_equal_steps_and_leave_the_tool(self):
        process, _ = self.open_window()
        width = lambda: int(tissue(self.scene()[360]).sum())  # of the organ, in the middle row
        near = width()
        ways = {
            "wheel": (("click", "--repeat", 4, 5), ("click", "--repeat", 4, 4)),
            "keys": (("key", "minus", "minus", "minus", "KP_Subtract"), ("key", "plus", "equal", "KP_Add", "plus")),
            # 20 pixels a step
            "drag": tuple(("keydown", "ctrl", "mousedown", 3, "mousemove_relative", "--", 0, way, "mouseup", 3, "keyup", "ctrl")
                          for way in (80, -80)),
        }
        for way, (out, back) in ways.items():
            with self.subTest(way):
                self.x("xdotool", *out)
                far = width()
                # The front of the organ is nearer than the point that is looked at, so that it grows by more.
                self.assertGreater(near / far, ZOOMED)
                self.assertLess(near / far, 1.2 * ZOOMED)
                self.x("xdotool", *back)
                self.assertAlmostEqual(width() / near, 1, delta=STEPPED)
        self.assertEqual(self.close(process)["device_travel_mm"], 0)

    def test_b_hides_what_is_rigid_from_the_eye_and_from_the_pointer(self):
        process, window = self.open_window()
        self.x("xdotool", "click", "--repeat", 8, 5)  # the skull comes into sight at the right
        self.come_to_rest()
        bones, organ, _, column = self.seen()
        self.assertGreater(bones, 100 * SEEN)
        # To where it was.
        self.x("xdotool", "key", "b", "mousemove", "--window", window, 1150, 360)
        self.come_to_rest()
        hidden, organ_alone, _, column_still = self.seen()
        self.assertEqual(hidden, 0)
        self.assertAlmostEqual(organ_alone / organ, 1, delta=STEPPED)
        self.assertAlmostEqual(column_still, column, delta=2)
        self.x("xdotool", "key", "b")
        self.come_to_rest()
        self.assertAlmostEqual(self.seen()[0] / bones, 1, delta=STEPPED)
        self.x("xdotool", "mousemove", "--window", window, 1151, 360)
        self.come_to_rest()
        column_there = self.seen()[3]
        self.assertGreater(column_there, column + 200)
        self.assertGreater(self.close(process)["device_travel_mm"], 10)

    def test_c_cuts_away_what_hides_the_tool_until_it_is_pressed_again(self):
        process, _ = self.open_window()
        self.x("xdotool", "click", "--repeat", 8, 5)
        self.assertGreater(self.seen()[2], SEEN)
        self.x("xdotool", "mousedown", 3, "mousemove_relative", 430, 0, "mouseup", 3)  # to the organ's other side
        _, organ, ball, _ = self.seen()
        self.assertEqual(ball, 0)
        self.x("xdotool", "key", "c")
        _, cut_organ, ball, _ = self.seen()
        self.assertGreater(ball, SEEN)
        self.assertLess(cut_organ, 0.1 * organ)
        self.x("xdotool", "key", "c")
        _, whole_organ, ball, _ = self.seen()
        self.assertEqual(ball, 0)
        self.assertAlmostEqual(whole_organ / organ, 1, delta=STEPPED)
        self.assertEqual(self.close(process)["device_travel_mm"], 0)


class StiffnessMap(ViewOfOrgan):
    variant = ("stiffness",)

    def test_g_colours_the_organ_by_its_stiffness_beside_a_scale_and_back(self):
        process, _ = self.open_window()
        organ = self.seen()[1]
        scale = (slice(330, 560), slice(30, 100))  # rows and columns: between figures and hints at the left
        before = self.scene()
        self.x("xdotool", "key", "g")
        self.come_to_rest()
        coloured = self.scene()
        self.assertLess(int(tissue(coloured[SCENE]).sum()), 0.5 * organ)
        self.assertGreater(np.ptp(coloured[scale].sum(2)), np.ptp(before[scale].sum(2)) + 100)
        self.x("xdotool", "key", "g")
        self.come_to_rest()
        self.assertAlmostEqual(self.seen()[1] / organ, 1, delta=STEPPED)
        self.close(process)


if __name__ == "__main__":
    unittest.main()
