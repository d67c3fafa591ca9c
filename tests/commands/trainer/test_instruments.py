# SPDX-License-Identifier: Apache-2.0
"""palpate-train with a whole instrument: what is drawn, seen from its tip and recorded is the body that is felt."""

import json
import math
import os
import pathlib
import subprocess
import sys
import time
import unittest

import numpy as np

from test_view_keys import SCENE, bone, tissue
from trainer_case import TRAIN, TrainerCase, difference
from recorded import kept  # found by trainer_case

TOOLS = pathlib.Path(os.environ["PALPATE_SOURCE"]) / "sample_data" / "tools.py"
HALF = math.sqrt(0.5)
UPRIGHT, LYING, UPSIDE_DOWN = "0 0 0 1", f"{HALF} 0 0 {HALF}", "1 0 0 0"
BETWEEN = 28, 10, 42  # mm, above organ (x < 20) and skull (its top at x = 40): both are within 45 degrees of straight down


def degrees_between(one, other):
    return math.degrees(math.acos(((one.T @ other).trace() - 1) / 2))


class Instruments(TrainerCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        subprocess.run([sys.executable, TOOLS, cls.folder], check=True, stdout=subprocess.DEVNULL)

    def start(self, instrument, rows, *options):
        hand = self.folder / "hand.txt"
        hand.write_text("".join(f"{row}\n" for row in rows))
        process = self.launch("--instrument", self.folder / f"{instrument}.stl", "--script", hand, *options)
        self.find_window()
        return process

    def held(self, instrument, orientation, *keys):
        """The trainer with the instrument held there, after those keys."""
        place = " ".join(map(str, BETWEEN))
        process = self.start(instrument, [f"0 {place} {orientation}", f"60 {place} {orientation}"])
        self.x("xdotool", "key", "h", *keys)
        return process

    def close_after(self, process, take):
        time.sleep(1.5)  # the endoscope turns by and by
        taken = take()
        self.x("xdotool", "key", "q")
        self.finish(process)
        return taken

    def from_outside(self, turn):
        process = self.held("peg", turn)
        self.x("xdotool", "click", "--repeat", 10, 5)  # so far away that all of it is seen
        return self.close_after(process, lambda: self.scene()[SCENE].ravel().tolist())

    def from_tip(self):
        """How many pixels the endoscope has of bone and of tissue, and the way from the one's middle to the other's."""
        scene = self.scene()[SCENE]
        bones, organ = (np.argwhere(kind(scene)) for kind in (bone, tissue))
        return len(bones), len(organ), organ.mean(0) - bones.mean(0) if len(bones) and len(organ) else None

    def test_an_instrument_is_drawn_as_it_is_turned(self):
        upright, again, lying = map(self.from_outside, (UPRIGHT, UPRIGHT, LYING))
        self.assertGreater(difference(upright, lying), 3 * max(difference(upright, again), 0.2))

    def test_the_endoscope_looks_along_an_instrument(self):
        bones, organ, _ = self.close_after(self.held("endoscope", UPRIGHT, "v"), self.from_tip)
        self.assertGreater(min(bones, organ), 3000)
        self.assertEqual(self.close_after(self.held("endoscope", UPSIDE_DOWN, "v"), self.from_tip), (0, 0, None))

    def test_the_endoscope_s_picture_turns_with_the_instrument(self):
        place, quarter = " ".join(map(str, BETWEEN)), 6  # s that a quarter of a turn about its shaft takes
        turns = [(math.sin(n * math.pi / 4), math.cos(n * math.pi / 4)) for n in range(11)]
        process = self.start("endoscope", [f"{n * quarter} {place} 0 0 {s} {c}" for n, (s, c) in enumerate(turns)])
        self.x("xdotool", "key", "h", "v")

        def two_views():
            first = self.from_tip()[2]
            time.sleep(0.4 * quarter)
            return first, self.from_tip()[2]

        before, after = self.close_after(process, two_views)
        cosine = before @ after / (np.linalg.norm(before) * np.linalg.norm(after))
        self.assertLess(cosine, math.cos(math.radians(20)))  # 36 degrees or more

    def turned_by(self, *options, keys):
        """How the device was turned before and after those keys, R_PT: matrices."""
        recording = self.folder / "turned.h5"
        recording.unlink(missing_ok=True)
        process = self.launch(*options, "--record", recording)
        self.find_window()
        time.sleep(0.5)
        self.x("xdotool", "key", "--delay", 60, *keys)
        time.sleep(1)
        self.x("xdotool", "key", "q")
        self.finish(process)
        turned = kept(recording, "ticks/orientation")
        return [np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                          [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                          [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]]) for x, y, z, w in turned[[0, -1]]]

    def test_keys_turn_what_mouse_and_keyboard_hold(self):
        peg = "--instrument", self.folder / "peg.stl"
        for device in (), ("--device", "premium-6dof"):
            before, after = self.turned_by(*peg, *device, keys=["shift+Right"] * 6)
            self.assertAlmostEqual(degrees_between(before, after), 30, delta=1)
            rolled = [self.turned_by(*peg, *device, keys=[key] * 3)[1] for key in ("shift+w", "shift+s")]
            self.assertLess(np.linalg.norm(rolled[0][:, 2] - rolled[1][:, 2]), 0.02)
            self.assertAlmostEqual(degrees_between(*rolled), 30, delta=1)
        before, after = self.turned_by(*peg, keys=["shift+Up"] * 4 + ["r"])
        self.assertLess(np.abs(after - before).max(), 0.01)
        before, after = self.turned_by(keys=["shift+Right"] * 6)  # a ball does not turn
        self.assertTrue((before == after).all())

    def test_a_drag_turns_what_the_mouse_holds(self):
        recording = self.folder / "dragged.h5"
        process = self.launch("--instrument", self.folder / "peg.stl", "--record", recording)
        self.find_window()
        self.x("xdotool", "keydown", "shift", "mousedown", 3)
        for _ in range(10):
            self.x("xdotool", "mousemove_relative", 10, 0)
            time.sleep(0.05)
        self.x("xdotool", "mouseup", 3, "keyup", "shift")
        time.sleep(1)
        self.x("xdotool", "key", "q")
        self.finish(process)
        first, last = kept(recording, "ticks/orientation")[[0, -1]]
        self.assertAlmostEqual(math.degrees(2 * math.acos(min(1, abs(first @ last)))), 35, delta=1)

    def test_what_is_felt_in_the_window_is_recorded_and_replays(self):
        recording = self.folder / "peg.h5"
        rows = [f"0 36 10 30 {UPRIGHT}", f"0.5 36 10 23 {UPRIGHT}", f"1 36 10 23 {UPRIGHT}", f"1.5 36 10 30 {UPRIGHT}"]
        process = self.start("peg", rows, "--seconds", 2, "--record", recording)
        result = self.finish(process)
        self.assertGreater(result["force_peak_n"], 0.5)
        self.assertGreater(result["shown_late_ms"]["p50"], 0)
        touch = subprocess.run([TRAIN.with_name("palpate-touch"), self.asset, "--replay", recording, "--json", "-"], capture_output=True,
                               text=True, timeout=60)
        self.assertEqual(touch.returncode, 0, touch.stderr)
        replayed = json.loads(touch.stdout)
        self.assertEqual(replayed["replay"]["different_ticks"], 0)
        self.assertGreater(replayed["torque_peak_n_mm"], 1)

    def test_a_device_that_renders_torque_turns_in_its_hand(self):
        # Levered beside the skull's top for a while, felt and not.
        rows = [f"0 36 10 30 {UPRIGHT}", f"0.5 36 10 23 {UPRIGHT}", f"1.5 36 10 23 {UPRIGHT}", f"2 36 10 30 {UPRIGHT}"]
        for device, turns in (("premium", False), ("premium-6dof", True)):
            recording = self.folder / f"{device}.h5"
            result = self.finish(self.start("peg", rows, "--device", device, "--seconds", 2, "--record", recording))
            self.assertEqual(result["device"], f"simulated {device}, scripted hand")
            angle = np.degrees(2 * np.arccos(np.minimum(1, np.abs(kept(recording, "ticks/orientation")[:, 3])))).max()
            self.assertEqual(angle > 0.2, turns, angle)

    def test_a_run_whose_tool_began_in_bone_ends_with_a_line_that_says_so(self):
        process = self.start("peg", [f"0 40 10 15 {UPRIGHT}", f"2 40 10 15 {UPRIGHT}"], "--seconds", 1)
        out, err = process.communicate(timeout=30)
        self.assertEqual(process.returncode, 0, err)
        self.assertRegex(err, r"not all ticks were as they should be: .*\d+ starts_inside")
        self.assertGreater(json.loads(out)["statuses"]["starts_inside"], 100)


if __name__ == "__main__":
    unittest.main()
