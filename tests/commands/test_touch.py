# SPDX-License-Identifier: Apache-2.0
"""palpate-touch on the sample patient: what it writes, what it measures, what it refuses."""

import csv
import json
import math
import os
import pathlib
import subprocess
import unittest
import xml.etree.ElementTree

from sample_asset import SampleAsset

TOUCH = pathlib.Path(os.environ["PALPATE_BIN"]) / "palpate-touch"


class Touch(SampleAsset):
    def touch(self, *options):
        return subprocess.run(
            [TOUCH, self.asset, *map(str, options)], capture_output=True, text=True, timeout=60
        )

    def result(self, *options):
        run = self.touch(*options, "--json", "-")
        self.assertEqual(run.returncode, 0, run.stderr)
        return json.loads(run.stdout)

    def rows(self, path):
        with open(path, newline="") as file:
            return list(csv.DictReader(file))

    def test_press_grows_with_depth_and_ends_with_release(self):
        log, curve = self.folder / "press.csv", self.folder / "press.svg"
        result = self.result(
            "--virtual-clock", "--seconds", 2, "--log", log, "--curve", curve, "--force"
        )
        self.assertEqual(result["schema"], "palpate.touch/1")
        self.assertEqual(result["ticks"], 2000)
        self.assertEqual(result["target"]["body"], "wall")
        self.assertAlmostEqual(result["penetration"]["device_mm"], 3, places=3)
        self.assertLessEqual(result["penetration"]["tool_mm"], 1e-3)
        self.assertGreater(result["force_peak_n"], 0.01)
        self.assertLess(result["force_step_max_n"], 0.25 + 1e-9)

        rows = self.rows(log)
        self.assertEqual(len(rows), 2000)
        force = [math.hypot(*(float(r[f"force_{a}_n"]) for a in "xyz")) for r in rows]
        depth = [float(r["depth_mm"]) for r in rows]
        deepest = depth.index(max(depth))
        first = next(i for i, d in enumerate(depth) if d > 0)
        for i in range(first, deepest):
            self.assertGreaterEqual(force[i + 1], force[i])
        self.assertEqual(depth[0], 0)
        self.assertEqual(force[0], 0)
        self.assertTrue(any(f == 0 for f in force[deepest:]), "the force never ended")
        self.assertTrue(all(r["status"] == "ok" for r in rows))
        picture = xml.etree.ElementTree.parse(curve).getroot()
        self.assertTrue(picture.tag.endswith("svg"))

    def test_the_virtual_clock_gives_the_same_forces_every_time(self):
        def forces(name):
            self.result("--virtual-clock", "--script", "slide", "--seconds", 1, "--log", self.folder / name)
            return [[v for k, v in r.items() if k != "tick_us"] for r in self.rows(self.folder / name)]

        self.assertEqual(forces("one.csv"), forces("two.csv"))

    def test_the_real_clock_ticks_and_measures(self):
        result = self.result("--seconds", 1)
        self.assertGreaterEqual(result["ticks"] + result["overruns"], 1000)
        self.assertEqual(result["lost_log_records"], 0)
        for key in ("tick_us", "wake_latency_us"):
            values = [result[key][k] for k in ("p50", "p99", "p99_9", "max")]
            self.assertEqual(values, sorted(values))
        self.assertGreater(result["ready_s"], 0)

    def test_a_path_from_a_file_into_the_rigid_body(self):
        script = self.folder / "hand.txt"
        script.write_text("# down onto the skull and up again\n0 40 10 30\n0.5, 40, 10, 24\n1 40 10 30\n")
        log = self.folder / "file.csv"
        result = self.result("--virtual-clock", "--script", script, "--log", log)
        self.assertEqual(result["ticks"], 1000)
        self.assertNotIn("target", result)
        # The skull's top is at 25 mm, the tool of 1.5 mm rests at 26.5: 2.5 mm of 0.4 N/mm.
        self.assertAlmostEqual(result["force_peak_n"], 1.0, delta=0.05)
        self.assertLessEqual(result["penetration"]["tool_mm"], 1e-3)
        self.assertEqual(result["peak"]["contacts"][0]["body"], "skull")

    def second(self):
        """A second hand, which goes down onto the skull beside the first one's place."""
        script = self.folder / "second.txt"
        script.write_text("0 40 10 30\n0.5 40 10 24\n2 40 10 24\n")
        return script

    def test_two_tools_feel_each_their_own_contact(self):
        log = self.folder / "both.csv"
        alone = self.result("--virtual-clock", "--seconds", 1)
        both = self.result("--virtual-clock", "--seconds", 1, "--second", self.second(), "--log", log)
        self.assertEqual({row["tool"] for row in self.rows(log)}, {"0", "1"})
        self.assertAlmostEqual(both["force_peak_n"], alone["force_peak_n"], delta=1e-6)
        self.assertAlmostEqual(both["second"]["force_peak_n"], 1.0, delta=0.05)

    def test_each_scheme_pushes_and_the_published_ones_give_the_same_twice(self):
        for scheme in ("single", "twice", "continuous"):
            runs = [self.result("--virtual-clock", "--seconds", 2, "--scheme", scheme, "--device", "desktop")
                    for _ in range(2)]
            self.assertEqual(runs[0]["scheme"], scheme)
            self.assertGreater(runs[0]["force_peak_n"], 0.005)
            self.assertEqual(runs[0]["peak"], runs[1]["peak"])

    def test_the_coupling_keeps_to_what_the_device_bears(self):
        result = self.result("--virtual-clock", "--seconds", 1, "--device", "touch")
        self.assertEqual(result["coupling_stiffness_n_per_mm"], 0.4)  # the case asks for less than a Touch's 0.5
        self.assertIn("touch", result["device"])

    def test_a_random_hand_is_that_of_its_seed(self):
        def peak(seed):
            return self.result("--virtual-clock", "--seconds", 3, "--script", "random", "--seed", seed)["peak"]

        self.assertEqual(peak(1), peak(1))
        self.assertNotEqual(peak(1), peak(2))

    def test_a_target_with_negative_coordinates(self):
        result = self.result("--virtual-clock", "--seconds", 1, "--target", "-5,10,12")
        self.assertEqual(result["target"]["normal"], [-1, 0, 0])

    def test_refusals(self):
        bad = self.folder / "bad.txt"
        bad.write_text("1 2 3\n1 2\n")
        cases = [
            (["--script", "prod"], 3, "press, slide, random or a file"),
            (["--script", bad], 3, "line 2"),
            (["--body", "wal"], 2, "'wall'"),
            (["--target", "1,2"], 2, "--target"),
            (["--target", "1,2,3,4"], 2, "--target"),
            (["--seconds", "0"], 2, "--seconds"),
            (["--speed", "-1"], 2, "--speed"),
            (["--scheme", "thrice"], 2, "single, twice or continuous"),
            (["--device", "omni"], 2, "touch, desktop, premium"),
            (["--shaft", "0,0,0"], 2, "--shaft"),
            (["--scheme", "twice", "--second", self.second()], 2, "one tool"),
            (["--log", self.folder / "no" / "run.csv"], 3, "folder does not exist"),
        ]
        for options, code, message in cases:
            with self.subTest(options=options):
                run = self.touch("--virtual-clock", *options)
                self.assertEqual(run.returncode, code, run.stderr)
                self.assertIn(message, run.stderr)

    def test_an_existing_log_is_kept_without_force(self):
        log = self.folder / "kept.csv"
        log.write_text("mine")
        run = self.touch("--virtual-clock", "--seconds", 1, "--log", log)
        self.assertEqual(run.returncode, 3)
        self.assertEqual(log.read_text(), "mine")

    def test_nothing_heavy_is_linked(self):
        libraries = subprocess.run(["ldd", TOUCH], capture_output=True, text=True, check=True).stdout.lower()
        for name in ("itk", "cgal", "cholmod", "vtk", "openblas"):
            self.assertNotIn(name, libraries)


if __name__ == "__main__":
    unittest.main()
