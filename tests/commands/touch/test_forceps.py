# SPDX-License-Identifier: Apache-2.0
"""palpate touch --instrument forceps: two jaws that take hold of tissue, draw it away and let it go."""

import csv
import json
import math
import os
import pathlib
import subprocess
import sys
import unittest

import h5py

sys.path.insert(0, "..")
from sample_asset import SampleAsset  # noqa: E402

TOUCH = pathlib.Path(os.environ["PALPATE_BIN"]) / "palpate-touch"
# About the sample's soft cube of 20 mm, whose bottom is held; the skull stands beside it.
ASTRIDE = ["--jaw-length", 16, "--jaw-radius", 1, "--jaw-opening", 120]
FRICTION, GRIP, RADIUS = 0.11, 0.022, 1  # N/mm², mm: the defaults, and the jaws of ASTRIDE
SMOOTH = ["--jaw-friction", 0, "--jaw-grip", 0]
LOGGED = 1e-5  # N, of a log


def norm(vector):
    return math.hypot(*vector)


class Forceps(SampleAsset):
    def touch(self, *options):
        return subprocess.run([TOUCH, self.asset, *map(str, options)], capture_output=True, text=True, timeout=120)

    def result(self, *options):
        run = self.touch("--instrument", "forceps", *options, "--json", "-")
        self.assertEqual(run.returncode, 0, run.stderr)
        return json.loads(run.stdout)

    def logged(self, *options):
        """The run's result, and the rows of its log, of each jaw."""
        log = self.folder / "run.csv"
        result = self.result("--virtual-clock", *options, "--log", log, "--force")
        with open(log, newline="") as file:
            rows = list(csv.DictReader(file))
        return result, [[row for row in rows if row["tool"] == jaw] for jaw in "01"]

    def force(self, row):
        return [float(row[f"force_{axis}_n"]) for axis in "xyz"]

    def test_the_script_grasp_takes_hold_of_a_rim_draws_it_out_and_lets_it_go(self):
        result, jaws = self.logged(*ASTRIDE, "--seconds", 8, "--depth", 5)
        self.assertEqual(result["script"], "grasp")
        self.assertEqual(result["grasp"]["body"], "wall")
        self.assertAlmostEqual(result["grasp"]["thickness_mm"], 20, delta=1e-3)
        self.assertNotIn("contact_unsolved", result["statuses"])
        x, y, z, w = result["grasp"]["orientation"]
        shaft = [2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)]
        pinch = min(max(norm(self.force(row)) for row in jaw) for jaw in jaws)
        self.assertGreater(pinch, 0.05)
        # Jaws at an angle push themselves out of what they close about; drawn out, it draws back.
        sums = [[a + b for a, b in zip(self.force(one), self.force(other))] for one, other in zip(*jaws)]
        along = [sum(f * s for f, s in zip(force, shaft)) for force in sums]
        self.assertLess(min(along), -0.05 * pinch)
        _, smooth = self.logged(*ASTRIDE, "--seconds", 8, "--depth", 5, *SMOOTH)
        for one, other in zip(*smooth):  # which nothing holds
            slips = sum((a + b) * s for a, b, s in zip(self.force(one), self.force(other), shaft))
            self.assertGreater(slips, -0.02 * pinch)
        kick = max(norm([a - b for a, b in zip(now, before)]) for before, now in zip(sums, sums[1:]))
        self.assertLess(kick, 0.05 * pinch)
        self.assertEqual(norm(sums[-1]), 0)
        self.assertEqual(norm(sums[0]), 0)

    def press_and_drag_of_parts(self, *options):
        """Of each sphere of both jaws at the peak."""
        result = self.result("--virtual-clock", *ASTRIDE, "--seconds", 3, "--depth", 2, *options)
        for jaw in (result, result["second"]):
            press, drag = {}, {}
            for contact in jaw["peak"]["contacts"]:
                part = contact["part"]
                press[part] = press.get(part, 0) + contact["force_n"]
                drag[part] = [a + b for a, b in zip(drag.get(part, (0, 0, 0)), contact["friction_n"])]
            self.assertGreater(len(press), 1)  # several spheres of the jaw
            yield [(force, norm(drag[part])) for part, force in press.items()]

    def test_what_holds_is_coulombs_friction_of_the_jaws_and_their_grip(self):
        for parts in self.press_and_drag_of_parts("--jaw-friction", 0.83, "--jaw-grip", 0):
            for press, drag in parts:
                self.assertLessEqual(drag, 0.83 * press + LOGGED)
            self.assertGreater(max(drag for _, drag in parts), 0.1 * 0.83 * max(press for press, _ in parts))
        beyond = 0
        for parts in self.press_and_drag_of_parts():
            for press, drag in parts:
                self.assertLessEqual(drag, FRICTION * press + GRIP * math.pi * RADIUS**2 + LOGGED)
                beyond = max(beyond, drag - FRICTION * press)
        self.assertGreater(beyond, 0.001)  # N, that Coulomb's friction alone would not hold
        smooth, jaws = self.logged(*ASTRIDE, "--seconds", 3, *SMOOTH)
        for contact in smooth["peak"]["contacts"] + smooth["second"]["peak"]["contacts"]:
            self.assertEqual(contact["friction_n"], [0, 0, 0])

    def test_a_script_of_ones_own_turns_and_opens_it(self):
        half = math.sqrt(0.5)
        path = self.folder / "jaws.txt"
        # On its side above the cube: its shaft along y, its jaws along x, closing.
        path.write_text(f"0 10 10 60 {-half:.9f} 0 0 {half:.9f} 60\n1 10 10 60 {-half:.9f} 0 0 {half:.9f} 0\n")
        result, jaws = self.logged("--script", path, "--jaw-length", 20, "--jaw-radius", 2)
        self.assertEqual((result["script"], len(jaws[0])), ("file", 1000))
        for tick, angle in ((499, 30.03), (999, 0)):
            aside = 2 + 20 * math.sin(math.radians(angle) / 2)
            back = 20 * (1 - math.cos(math.radians(angle) / 2))
            for jaw, side in zip(jaws, (1, -1)):
                place = [float(jaw[tick][f"device_{axis}_mm"]) for axis in "xyz"]
                for found, expected in zip(place, (10 + side * aside, 10 + back, 60)):
                    self.assertAlmostEqual(found, expected, delta=0.02)

    def test_a_device_that_gives_way_feels_both_jaws(self):
        result = self.result("--virtual-clock", "--device", "touch", *ASTRIDE, "--seconds", 3, "--depth", 2)
        self.assertIn("simulated touch", result["device"])
        self.assertLessEqual(result["coupling_stiffness_n_per_mm"], 0.25)  # of a Touch's 0.5, for two jaws
        self.assertGreater(result["second"]["force_peak_n"], 0.02)

    def test_a_recording_says_what_the_jaws_were_and_replays_bit_for_bit(self):
        path = self.folder / "grasp.h5"
        self.result("--virtual-clock", *ASTRIDE, "--seconds", 4, "--depth", 2, "--record", path, "--force")
        with h5py.File(path) as file:
            self.assertEqual(file.attrs["tools"], 2)
            haptics = dict(file["haptics"].attrs)
        self.assertEqual((haptics["tool_radius"], haptics["shaft_length"]), (1, 16))
        self.assertEqual((haptics["friction_at_rest"], haptics["friction_sliding"], haptics["grip"]), (FRICTION, FRICTION, GRIP))
        run = self.touch("--replay", path, "--json", "-")
        self.assertEqual(run.returncode, 0, run.stderr)
        replay = json.loads(run.stdout)["replay"]
        self.assertEqual((replay["ticks"], replay["different_ticks"]), (4000, 0))

    def test_refusals_name_the_culprit_and_the_next_step(self):
        bare = self.folder / "bare.txt"
        bare.write_text("0 10 10 60 0 0 0 1\n1 10 10 60 0 0 0 1\n")
        (self.folder / "jaws_here.txt").write_text("0 10 10 60 0 0 0 1 20\n1 10 10 60 0 0 0 1 20\n")
        forceps = ["--instrument", "forceps"]
        cases = [
            (["--script", "grasp"], 2, ["--script: grasp", "--instrument forceps beside it"]),
            (["--jaw-length", 25], 2, ["--jaw-length: without --instrument forceps"]),
            ([*forceps, "--rod-length", 20], 2, ["--rod-length: with --instrument forceps"]),
            ([*forceps, "--jaw-friction", 6], 2, ["--jaw-friction: is 6", "0 to 5"]),
            ([*forceps, "--jaw-grip", 22], 2, ["--jaw-grip: is 22", "0 to 1"]),
            ([*forceps, "--scheme", "twice"], 2, ["--instrument: forceps with --scheme twice", "--scheme continuous"]),
            ([*forceps, "--script", "press"], 2, ["--script: press with --instrument forceps", "grasp or a file"]),
            ([*forceps, "--second", bare], 2, ["--second: with --instrument forceps"]),
            ([*forceps, "--shaft", "0,0,1"], 2, ["--shaft: with --instrument forceps"]),
            ([*forceps, "--script", bare], 3, ["bare.txt: no jaw angles", "t x y z qx qy qz qw and an angle"]),
            (["--script", self.folder / "jaws_here.txt"], 3, ["jaws_here.txt: jaw angles where no forceps is held"]),
            ([*forceps, "--body", "skull"], 2, ["--body: 'skull' is rigid", "takes hold of tissue"]),
            ([*forceps, "--jaw-length", 5], 3, ["wall: has no rim that fits", "--jaw-length"]),
            ([*forceps, *ASTRIDE, "--depth", -1], 2, ["--depth"]),
        ]
        for options, code, messages in cases:
            with self.subTest(options=options):
                run = self.touch("--virtual-clock", "--seconds", 0.1, *options)
                self.assertEqual(run.returncode, code, run.stderr)
                for message in messages:
                    self.assertIn(message, run.stderr)


if __name__ == "__main__":
    unittest.main()
