# SPDX-License-Identifier: Apache-2.0
"""A teacher makes an exercise in a real window of palpate-train, by mouse and keys; a hand does it afterwards."""

import pathlib
import shutil
import time
import tomllib
import unittest

from trainer_case import TrainerCase

RADIUS = 1.5  # mm, of the sample's tool


def outward(place):
    """The normal of the side of the cube [0, 20]^3 mm on which a place lies."""
    return [1 if abs(p - 20) < 0.01 else -1 if abs(p) < 0.01 else 0 for p in place]


class Teacher(TrainerCase):
    def setUp(self):
        self.own = self.folder / self.id().rsplit(".")[-1]
        self.own.mkdir()
        self.asset = pathlib.Path(shutil.copy(self.asset, self.own))

    def start(self, *options):
        process = self.launch("--attempts", self.own / "attempts", *options, folder=self.own)
        window = self.find_window()
        time.sleep(1)  # the start page's pictures are taken
        return process, window

    def keys(self, *keys):
        for key in keys:
            self.x("xdotool", "key", key)
            time.sleep(0.3)  # a key is a page's or the window's as of the last frame

    def finish(self, process):
        return super().finish(process)["attempts"]

    def press_and(self, window, x, y, *keys):
        """Presses the organ under a pixel, and keys meanwhile."""
        self.x("xdotool", "mousemove", "--window", window, x, y)
        time.sleep(0.8)
        self.x("xdotool", "mousedown", 1)
        time.sleep(0.8)
        self.keys(*keys)
        self.x("xdotool", "mouseup", 1)
        time.sleep(0.5)

    def test_an_exercise_is_made_tried_saved_and_done_by_a_hand(self):
        process, window = self.start()
        self.keys("F2", "space")  # a new exercise; to the organ
        self.press_and(window, 760, 250, "m")
        self.press_and(window, 700, 290, "m")
        self.press_and(window, 740, 320, "m", "Delete")
        self.keys("space", "4", "plus", "plus")  # the page; the most force
        self.keys("5", "plus", "7", "plus", "plus", "2", "BackSpace", "q", "Return")  # a title may have a q
        self.keys("t")  # tries it: three seconds, then it runs
        time.sleep(3.5)
        self.keys("e", "F2", "s")  # ended; changed once more; saved
        self.keys("BackSpace", "q")
        (tried,) = self.finish(process)
        self.assertEqual(tried["ending"], "ended")

        (file,) = self.own.glob("*.toml")
        (made,) = tomllib.loads(file.read_text())["exercise"]
        self.assertEqual((made["name"], made["task"], made["title"]), ("touch-1", "touch", "touch-q"))
        self.assertEqual(made["time_limit_s"], 20)
        self.assertEqual(len(made["places_mm"]), 2)
        self.assertEqual(made["places_mm"], tried["exercise"]["places_mm"])
        for key in ("least_force_n", "most_force_n", "tolerance_mm", "hold_s", "title"):
            self.assertEqual(made[key], tried["exercise"][key], key)

        rows, t = [], 0.0
        for place in made["places_mm"]:
            normal = outward(place)
            for dt, height in ((0.3, 15), (0.5, 4), (0.3, -2), (2, -2), (0.3, 4), (0.5, 15)):
                t += dt
                at = (p + (RADIUS + height) * n for p, n in zip(place, normal))
                rows.append(" ".join(f"{value:.4f}" for value in (t, *at)))
        hand = self.own / "hand.txt"
        hand.write_text("\n".join(["0 " + rows[0].split(" ", 1)[1], *rows]))
        self.assertEqual(file.name, "sample-exercises.toml")  # beside the asset, which takes it from now on
        process, _ = self.start("--exercise", "touch-1", "--script", hand, "--seconds", t + 0.5)
        (attempt,) = self.finish(process)
        self.assertEqual(attempt["ending"], "all reached")
        self.assertGreater(attempt["metrics"]["score"], 90)

    def test_what_else_is_in_the_file_stays_and_the_changed_exercise_takes_its_place(self):
        file = self.own / "own.toml"
        head, old = "# of our clinic\nschema = 1\n\n", '[[exercise]]\nname = "a"\ntask = "touch"\nplaces_mm = [[10, 10, 20]]\n'
        rest = '\n# the second\n[[exercise]]\nname = "b"\ntask = "free"\n'
        file.write_text(head + old + rest)
        process, window = self.start("--exercises", file)
        self.keys("1", "F2", "6", "plus", "plus", "s", "BackSpace", "q")
        self.finish(process)
        text = file.read_text()
        self.assertTrue(text.startswith(head) and text.endswith(rest), text)
        a, b = tomllib.loads(text)["exercise"]
        self.assertEqual((a["name"], a["hold_s"], a["places_mm"]), ("a", 0.7, [[10, 10, 20]]))
        self.assertEqual(b, {"name": "b", "task": "free"})

    def test_gates_are_set_at_the_tip_and_a_folder_that_cannot_be_written_is_told(self):
        process, _ = self.start()
        self.keys("F2", "plus", "plus", "space", "m")  # touch, find, guide
        self.x("xdotool", "key", "--repeat", "8", "s")  # half a millimetre each
        time.sleep(0.5)
        self.keys("m", "space")
        (self.own / "sample-exercises.toml").mkdir()
        self.keys("s")
        time.sleep(1)
        (self.own / "sample-exercises.toml").rmdir()
        self.assertEqual(list(self.own.glob("*.toml")), [])
        self.keys("s", "BackSpace", "q")
        self.finish(process)
        (file,) = self.own.glob("*.toml")
        (made,) = tomllib.loads(file.read_text())["exercise"]
        self.assertEqual((made["name"], made["task"]), ("guide-1", "guide"))
        first, second = made["places_mm"]
        distance = sum((a - b) ** 2 for a, b in zip(first, second)) ** 0.5
        self.assertAlmostEqual(distance, 4, delta=0.5)


if __name__ == "__main__":
    unittest.main()
