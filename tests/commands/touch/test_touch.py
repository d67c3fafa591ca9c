# SPDX-License-Identifier: Apache-2.0
"""palpate-touch on the sample patient: what it writes, what it measures, what it refuses."""

import csv
import gzip
import json
import math
import os
import pathlib
import subprocess
import sys
import unittest
import xml.etree.ElementTree

sys.path.insert(0, "..")
from sample_asset import SampleAsset  # noqa: E402

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

    def test_what_a_user_must_know_of_the_ticks_ends_the_run_in_one_line_and_nothing_else_does(self):
        script = self.folder / "inside.txt"
        script.write_text("0 40 10 15\n1 40 10 15\n")  # 10 mm below the skull's top
        inside = self.touch("--virtual-clock", "--script", script, "--json", "-")
        self.assertEqual(json.loads(inside.stdout)["statuses"], {"starts_inside": 1000})
        said = [line for line in inside.stderr.splitlines() if "starts_inside" in line]
        self.assertEqual(len(said), 1, inside.stderr)
        self.assertIn("1000 starts_inside (a tool is in a body, which is not felt until", said[0])
        # The force follows a jump of the hand as fast as it may, which is ordinary.
        script.write_text("0 40 10 30\n0.5 40 10 30\n0.501 40 10 24\n1 40 10 24\n")
        jump = self.touch("--virtual-clock", "--script", script, "--json", "-")
        self.assertEqual(set(json.loads(jump.stdout)["statuses"]), {"rate_limited"})
        self.assertNotIn("ticks", jump.stderr)

    def test_an_implausible_depth_is_questioned(self):
        run = self.touch("--virtual-clock", "--seconds", 0.5, "--depth", 300)
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertIn("300 mm depth is implausible", run.stderr)

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
        for scheme in ("single", "twice", "single-renewed", "twice-renewed", "continuous"):
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

    def depths(self, *options):
        """Time, depth and size of the force of each tick, and the run's result."""
        log = self.folder / "run.csv"
        result = self.result("--virtual-clock", *options, "--log", log, "--force")
        rows = self.rows(log)
        force = [math.hypot(*(float(r[f"force_{a}_n"]) for a in "xyz")) for r in rows]
        return [float(r["t_s"]) for r in rows], [float(r["depth_mm"]) for r in rows], force, result

    def test_a_hand_that_trembles_shakes_the_force_and_one_that_presses_does_not(self):
        def variation(script):
            time, _, force, result = self.depths("--script", script, "--device", "premium", "--seconds", 3)
            self.assertEqual(result["script"], script)
            held = [f for t, f in zip(time, force) if 1.2 < t < 1.5 or 1.9 < t < 2.2]
            return max(held) - min(held)

        # The tremor is 0.3 mm to either side at most, of 3 mm.
        peak = self.result("--virtual-clock", "--seconds", 3, "--device", "premium")["force_peak_n"]
        self.assertGreater(variation("tremble"), 0.04 * peak)
        self.assertLess(variation("tremble"), 0.3 * peak)

    def test_a_device_that_is_let_go_gives_way_and_is_taken_up_without_a_kick(self):
        # The place where a skull pushes hardest, so that the device's friction does not hold it there.
        options = ("--script", "let-go", "--device", "premium", "--body", "skull", "--seconds", 2.4)
        time, depth, force, result = self.depths(*options)
        deep = max(range(len(time)), key=lambda i: depth[i])
        gone = next(i for i in range(deep, len(time)) if force[i] == 0)
        self.assertGreater(force[deep], 0.3)
        self.assertLess(time[gone] - time[deep], 0.6)
        self.assertEqual(result["statuses"], {})
        self.assertLess(result["force_step_max_n"], 0.25)

    def test_motors_that_are_pressed_too_long_warm_up_and_the_force_goes_to_zero(self):
        script = self.folder / "long.txt"
        script.write_text("0 40 10 30\n1 40 10 13\n25 40 10 13\n")
        time, depth, force, _ = self.depths("--script", script, "--device", "touch")
        # A Touch bears 0.88 N for ever; its motors warm in 100 s: T' = ((F / 0.88)² - T) / 100.
        temperature, warm = 0.0, None
        for i, f in enumerate(force):
            heating = (f / 0.88) ** 2
            temperature = heating + (temperature - heating) * math.exp(-1e-5)
            if temperature >= 1:
                warm = i + 1  # the state at the end of this tick is read by the next
                break
        self.assertIsNotNone(warm, "the motors stayed cool")
        self.assertGreater(time[warm], 10)
        self.assertGreater(min(force[warm - 100 : warm - 2]), 2)  # two ticks for the log's rounding
        self.assertEqual(max(force[warm + 22 : warm + 5000]), 0)
        self.assertGreater(min(depth[warm : warm + 5000]), 1)  # though the hand presses on

    def test_a_hand_of_infinite_stiffness_cannot_let_go(self):
        run = self.touch("--virtual-clock", "--script", "let-go")
        self.assertEqual(run.returncode, 2, run.stderr)
        self.assertIn("--device", run.stderr)

    def test_a_simulated_device_is_felt_where_the_rigid_hand_is_whatever_way_the_surface_faces(self):
        for target in ("-5,10,12", "5,10,40", "5,-30,12"):
            peaks = [self.result("--virtual-clock", "--seconds", 1, "--target", target, *device)["peak"]
                     for device in ((), ("--device", "premium"))]
            rigid, simulated = (p["device_mm"] for p in peaks)
            # The hand gives way by force and friction over its 0.3 N/mm, and its encoders round.
            self.assertLess(math.dist(rigid, simulated), 0.6, target)
            norms = [math.hypot(*p["force_n"]) for p in peaks]
            along = sum(a * b for a, b in zip(peaks[0]["force_n"], peaks[1]["force_n"]))
            self.assertGreater(along, 0.99 * norms[0] * norms[1], target)

    def test_one_axis_of_a_recording_moves_the_tool_along_the_normal(self):
        recording = self.folder / "axis.csv"
        recording.write_text("% time, angle\n" + "".join(f"{i / 1000},{500 - abs(i - 500)}\n" for i in range(1001)))
        time, depth, force, result = self.depths("--script", recording, "--column", 2, "--depth", 2)
        self.assertEqual(result["script"], "file")
        self.assertEqual(len(time), 1000)
        self.assertAlmostEqual(max(depth), 2, places=2)
        for t, d in zip(time, depth):  # from 5 mm clear to 2 mm deep and back
            self.assertAlmostEqual(d, max(0, 7 * (1 - abs(2 * t - 1)) - 5), delta=1e-3)
        self.assertEqual(force.index(max(force)), 499)

    def test_a_real_trace_drives_a_run(self):
        traces = pathlib.Path(os.environ.get("PALPATE_DATA", "/nonexistent")) / "trace_mrdlab"
        if not traces.is_dir():
            self.skipTest("PALPATE_DATA has no trace_mrdlab")
        recording = self.folder / "trace.csv"
        with gzip.open(traces / "Tool_4_Maryland_L_2_00.csv.gz", "rt") as packed:
            text = packed.read()
        recording.write_text(text)
        # Column 2 is the angle of the tool's input shaft in encoder counts: a hand's slow opening and closing,
        # which begins and ends at its smallest. The other nine are times, torques, currents and commands.
        angle = [float(line.split(",")[1]) for line in text.splitlines() if line[:1] not in ("%", "")]
        time, depth, force, result = self.depths("--script", recording, "--column", 2, "--depth", 3)
        self.assertEqual(result["ticks"], len(angle) - 1)
        self.assertEqual(result["statuses"], {})
        clearance = min(5, result["target"]["clearance_mm"])
        scale = (clearance + 3) / (max(angle) - min(angle))
        for i, d in enumerate(depth):  # the first row is at time 0, before the first tick
            self.assertAlmostEqual(d, max(0, (angle[i + 1] - min(angle)) * scale - clearance), delta=1e-3)
        # The force follows the depth, whichever way it is reached.
        self.assertGreater(max(force), 0)
        by_depth = sorted(zip(depth, force))
        for (_, f), (_, deeper) in zip(by_depth, by_depth[1:]):
            self.assertGreater(deeper, f - 0.02 * max(force))
        simulated = self.result("--virtual-clock", "--script", recording, "--column", 2, "--device", "desktop")
        self.assertGreater(simulated["force_peak_n"], 0.8 * max(force))

    def test_a_target_with_negative_coordinates(self):
        result = self.result("--virtual-clock", "--seconds", 1, "--target", "-5,10,12")
        self.assertEqual(result["target"]["normal"], [-1, 0, 0])

    def test_refusals(self):
        bad = self.folder / "bad.txt"
        bad.write_text("1 2 3\n1 2\n")
        cases = [
            (["--script", "prod"], 3, "press, slide, tremble, let-go, random or a file"),
            (["--script", "press", "--column", 2], 2, "a file of a recorded axis"),
            (["--script", "prod", "--column", 2], 3, "no such script or file"),
            (["--script", bad, "--column", 3], 3, "line 2: no column 3"),
            (["--script", bad, "--column", 0], 3, "no column 0"),
            (["--script", bad], 3, "line 2"),
            (["--body", "wal"], 2, "'wall'"),
            (["--target", "1,2"], 2, "--target"),
            (["--target", "1,2,3,4"], 2, "--target"),
            (["--seconds", "0"], 2, "--seconds"),
            (["--speed", "-1"], 2, "--speed"),
            (["--scheme", "thrice"], 2, "expected single, twice"),
            (["--device", "omni"], 2, "touch, desktop, premium, premium-6dof"),
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
