# SPDX-License-Identifier: Apache-2.0
"""palpate touch --record and --replay: every tick is kept, and gives the same forces again."""

import csv
import json
import os
import pathlib
import signal
import subprocess
import sys
import time
import unittest

import h5py
import numpy as np

sys.path.insert(0, "..")
from recorded import kept  # noqa: E402
from sample_asset import TESTS, SampleAsset  # noqa: E402

TOUCH = pathlib.Path(os.environ["PALPATE_BIN"]) / "palpate-touch"


class Record(SampleAsset):
    def touch(self, *options, asset=None):
        return subprocess.run(
            [TOUCH, asset or self.asset, *map(str, options)], capture_output=True, text=True, timeout=120
        )

    def result(self, *options, code=0):
        run = self.touch(*options, "--json", "-")
        self.assertEqual(run.returncode, code, run.stderr)
        return json.loads(run.stdout)

    def recorded(self, name, *options):
        path = self.folder / name
        return path, self.result(*options, "--record", path, "--record-seconds", 20)

    def assert_replays(self, path, ticks):
        result = self.result("--replay", path)
        replay = result["replay"]
        self.assertEqual(replay["different_ticks"], 0)
        self.assertEqual(replay["ticks"], ticks)
        self.assertEqual(replay["started_at_tick"], 0)
        self.assertEqual(replay["missing_ticks"], 0)
        self.assertEqual(replay["largest_difference_n"], 0)
        return result

    def test_a_virtual_run_replays_bit_for_bit_with_the_same_log(self):
        log, again = self.folder / "log.csv", self.folder / "again.csv"
        path, run = self.recorded("virtual.h5", "--virtual-clock", "--script", "slide", "--seconds", 3, "--log", log)
        self.assertEqual(run["recording"], {"rows": 3000, "lost_rows": 0})
        replay = self.assert_replays(path, 3000)
        for key in ("force_peak_n", "force_step_max_n", "penetration", "peak", "scheme"):
            self.assertEqual(run[key], replay[key])
        curve = self.folder / "again.svg"
        self.result("--replay", path, "--log", again, "--curve", curve)
        self.assertEqual(log.read_bytes(), again.read_bytes())
        self.assertTrue(curve.exists())

    def test_a_run_in_real_time_replays_bit_for_bit(self):
        path, run = self.recorded("real.h5", "--seconds", 1.5, "--device", "touch")
        self.assertEqual(run["recording"]["rows"] + run["recording"]["lost_rows"], run["ticks"])
        if run["recording"]["lost_rows"] == 0:
            self.assert_replays(path, run["ticks"])
        # The loop's end takes the force away: that too is in the record, and comes again.
        self.assertNotEqual(kept(path, "ticks/faults")[-1], 0)

    def test_a_run_with_two_tools_replays_bit_for_bit(self):
        hand = self.folder / "second.txt"
        hand.write_text("0 40 10 30\n0.5 40 10 24\n1 40 10 30\n")
        path, run = self.recorded("two.h5", "--virtual-clock", "--seconds", 2, "--second", hand)
        self.assertEqual(run["recording"]["rows"], 4000)
        replay = self.assert_replays(path, 2000)
        self.assertEqual(run["second"]["force_peak_n"], replay["second"]["force_peak_n"])
        self.assertGreater(run["second"]["force_peak_n"], 0)

    def test_the_published_schemes_replay_bit_for_bit_by_both_clocks(self):
        for scheme in ("single", "twice"):
            for clock in (["--virtual-clock"], []):
                with self.subTest(scheme=scheme, clock=clock):
                    path, run = self.recorded(f"{scheme}{len(clock)}.h5", *clock, "--scheme", scheme, "--seconds", 1.5)
                    self.assertGreater(run["force_peak_n"], 0)
                    if run["recording"]["lost_rows"] == 0:
                        replay = self.assert_replays(path, run["ticks"])
                        self.assertEqual(replay["scheme"], scheme)

    def test_a_ring_keeps_the_end_of_a_run_and_replays_from_a_free_tick(self):
        path = self.folder / "ring.h5"
        run = self.result("--virtual-clock", "--seconds", 6, "--record", path, "--record-seconds", 2)
        self.assertEqual(run["recording"]["rows"], 6000)
        self.assertEqual(kept(path, "ticks/tick").tolist(), list(range(4001, 6000)))
        replay = self.result("--replay", path)["replay"]
        self.assertGreater(replay["started_at_tick"], 4001)
        self.assertEqual(replay["missing_ticks"], 4001)
        self.assertEqual(replay["ticks"] + replay["skipped_ticks"], 1999)
        self.assertGreater(replay["ticks"], 500)
        self.assertEqual(replay["different_ticks"], 0)

    def test_python_reads_what_the_log_says(self):
        log = self.folder / "python.csv"
        path, run = self.recorded("python.h5", "--virtual-clock", "--seconds", 1, "--log", log)
        force = kept(path, "ticks/force")
        with open(log, newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(len(rows), len(force))
        for row, f in zip(rows, force):
            for axis, value in zip("xyz", f):
                self.assertAlmostEqual(float(row[f"force_{axis}_n"]), value, places=5)
        with h5py.File(path) as file:
            self.assertEqual(file.attrs["case"].decode(), run["case"])
            self.assertEqual(file.attrs["scheme"].decode(), "continuous")
            self.assertEqual(file.attrs["coupling_stiffness"], run["coupling_stiffness_n_per_mm"])
            self.assertEqual(file["ticks/force"].attrs["unit"].decode(), "N")
            # The contacts of the peak are there, with the forces that the result names.
            peak = int(np.argmax(np.linalg.norm(force, axis=1)))
            first, count = file["ticks/first_contact"][peak], file["ticks/contact_count"][peak]
            forces = file["contacts/force"][first : first + count]
            self.assertEqual(count, len(run["peak"]["contacts"]))
            for contact, value in zip(run["peak"]["contacts"], forces):
                self.assertAlmostEqual(contact["force_n"], float(value))

    def test_a_changed_input_ends_with_exit_code_4_and_the_tick(self):
        path, _ = self.recorded("changed.h5", "--virtual-clock", "--seconds", 1)
        with h5py.File(path, "r+") as file:
            force = np.linalg.norm(file["ticks/force"][:1000], axis=1)
            tick = int(np.argmax(force))
            position = file["ticks/device_position"][tick]
            bits = position.view(np.int64)
            bits ^= 1 << 40  # some nanometres
            file["ticks/device_position"][tick] = position
        run = self.touch("--replay", path, "--json", "-")
        self.assertEqual(run.returncode, 4, run.stderr)
        self.assertIn(f"tick {tick} of tool 0", run.stderr)
        replay = json.loads(run.stdout)["replay"]
        self.assertEqual(replay["first_difference"]["tick"], tick)
        self.assertGreaterEqual(replay["different_ticks"], 1)
        self.assertGreater(replay["largest_difference_n"], 0)

    def test_another_asset_is_refused_and_both_are_named(self):
        path, _ = self.recorded("asset.h5", "--virtual-clock", "--seconds", 0.1)
        other = self.folder / "other.vtkhdf"
        subprocess.run([TESTS / "write_sample_case", other], check=True)
        run = self.touch("--replay", path, asset=other)
        self.assertEqual(run.returncode, 3)
        self.assertIn("asset.h5", run.stderr)
        self.assertIn("other.vtkhdf", run.stderr)
        with h5py.File(path) as file, h5py.File(other) as patient:
            self.assertIn(file.attrs["asset_sha256"].decode(), run.stderr)
            self.assertIn(patient["palpate"].attrs["manifest_sha256"].decode(), run.stderr)

    def test_a_killed_run_is_kept_and_replays(self):
        path = self.folder / "killed.h5"
        run = subprocess.Popen(
            [TOUCH, self.asset, "--seconds", "60", "--record", path, "--record-seconds", "20", "--quiet"],
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        try:
            deadline = time.monotonic() + 30
            written = 0
            while written < 500 and time.monotonic() < deadline:
                time.sleep(0.1)
                if path.exists():
                    with h5py.File(path) as file:
                        written = int(file["count/ticks"][0])
        finally:
            run.send_signal(signal.SIGKILL)
            run.wait()
        self.assertGreaterEqual(written, 500)
        ticks = kept(path, "ticks/tick")
        self.assertGreaterEqual(len(ticks), written)
        replay = self.result("--replay", path)["replay"]
        self.assertEqual(replay["different_ticks"], 0)
        self.assertEqual(replay["ticks"] + replay["missing_ticks"] + replay["skipped_ticks"], ticks[-1] + 1)

    def test_an_interrupted_run_is_kept(self):
        path = self.folder / "interrupted.h5"
        run = subprocess.Popen([TOUCH, self.asset, "--seconds", "60", "--record", path, "--record-seconds", "5"],
                               stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        while run.poll() is None and not path.exists():
            time.sleep(0.05)
        time.sleep(0.5)
        run.send_signal(signal.SIGINT)
        self.assertEqual(run.wait(timeout=30), 130)
        self.assertGreater(len(kept(path, "ticks/tick")), 0)

    def test_an_existing_recording_is_kept_without_force(self):
        path, _ = self.recorded("existing.h5", "--virtual-clock", "--seconds", 0.1)
        before = path.read_bytes()
        run = self.touch("--virtual-clock", "--seconds", 0.2, "--record", path)
        self.assertEqual(run.returncode, 3)
        self.assertIn("exists already", run.stderr)
        self.assertEqual(path.read_bytes(), before)
        self.result("--virtual-clock", "--seconds", 0.2, "--record", path, "--record-seconds", 5, "--force")
        self.assert_replays(path, 200)

    def test_what_makes_no_sense_is_refused(self):
        path, _ = self.recorded("sense.h5", "--virtual-clock", "--seconds", 0.1)
        self.assertEqual(self.touch("--replay", path, "--virtual-clock").returncode, 2)
        self.assertEqual(self.touch("--replay", path, "--script", "slide").returncode, 2)
        self.assertEqual(self.touch("--replay", path, "--record", self.folder / "copy.h5").returncode, 2)
        self.assertEqual(self.touch("--record", self.folder / "none.h5", "--record-seconds", 0).returncode, 2)
        self.assertFalse((self.folder / "none.h5").exists())
        run = self.touch("--replay", self.asset)
        self.assertEqual(run.returncode, 3)
        self.assertIn("sample.vtkhdf", run.stderr)


if __name__ == "__main__":
    unittest.main()
