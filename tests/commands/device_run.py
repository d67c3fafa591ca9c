# SPDX-License-Identifier: Apache-2.0
"""Runs of the sample that a device's faults and a user's signals meet, for tests of commands."""

import csv
import itertools
import json
import math
import os
import pathlib
import signal
import subprocess
import time

import numpy as np

from sample_asset import TESTS, SampleAsset
from recorded import kept

BIN = pathlib.Path(os.environ["PALPATE_BIN"])
LIBRARY = TESTS / "libpalpate_hd_conformance.so"
# Flags of formats/records/fault.hpp
DEVICE_LOST, TICK_LATE, VISUAL_STOPPED, ASSET_REMOVED, SERVO_STOPPING = 1 << 1, 1 << 7, 1 << 9, 1 << 10, 1 << 11
SLEW = 0.25 + 1e-6  # N a tick, the sample's max_force_rate
PATIENCE = 30  # s, for what comes within one on an idle machine

# A hand that stays outside while the run starts, however slowly, then presses 7 mm deep and stays. The device's
# y axis points out of the surface, and its workspace's middle is 5 mm above it.
PRESS = [[0, 0, 0, 0], [2, 0, 0, 0], [2.5, 0, -12, 0], [100, 0, -12, 0]]
RAS = np.array([-1, -1, 1])  # times LPS
RAMP = 15  # ticks, within which a fault takes any force to zero
FELT = 0.5  # N, what the hand feels at least of a skull, which does not give way; a ramp needs some ticks for it


def wait_until(condition, what):
    give_up = time.monotonic() + PATIENCE
    while not condition():
        if time.monotonic() > give_up:
            raise TimeoutError(what)
        time.sleep(0.02)


class DeviceRun(SampleAsset):
    """Runs of palpate-touch on the sample, and what their logs and recordings say."""

    numbers = itertools.count()

    def fresh(self, ending):
        return self.folder / f"{next(self.numbers)}{ending}"

    def driver(self, *devices, **more):
        """The environment in which the driver's library has `devices`."""
        script = self.fresh(".json")
        script.write_text(json.dumps({"devices": list(devices)}))
        return os.environ | {"PALPATE_HD_LIBRARY": str(LIBRARY), "PALPATE_HD_SCRIPT": str(script)} | more

    def touch(self, *options, environment=None):
        return subprocess.run([BIN / "palpate-touch", self.asset, *map(str, options)],
                              capture_output=True, text=True, timeout=60, env=environment)

    def result(self, *options, environment=None):
        run = self.touch(*options, "--json", "-", environment=environment)
        self.assertEqual(run.returncode, 0, run.stderr)
        return json.loads(run.stdout), run.stderr

    def logged(self, log):
        """Time, size of the force and faults of each tick."""
        with open(log, newline="") as file:
            rows = list(csv.DictReader(file))
        force = np.array([math.hypot(*(float(row[f"force_{axis}_n"]) for axis in "xyz")) for row in rows])
        return np.array([float(row["t_s"]) for row in rows]), force, [row["faults"].split("+") for row in rows]

    def begin(self, *options, environment=None, asset=None):
        """A run on the skull that would take a minute, and its recording."""
        recording = self.fresh(".h5")
        process = subprocess.Popen(
            [BIN / "palpate-touch", asset or self.asset, "--body", "skull", "--seconds", "60", "--record", recording,
             "--record-seconds", "30", *map(str, options)],
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment)
        self.addCleanup(process.communicate)
        self.addCleanup(process.kill)
        return process, recording

    def end(self, process, how=signal.SIGINT):
        process.send_signal(how)
        _, err = process.communicate(timeout=10)
        self.assertEqual(process.returncode, 130, err)
        return err

    def recorded(self, recording):
        """Size of the force and faults of each tick kept so far."""
        if not recording.exists():
            return np.zeros(0), np.zeros(0, int)
        force, faults = kept(recording, "ticks/force"), kept(recording, "ticks/faults")
        length = min(len(force), len(faults))  # the run goes on between the two
        return np.linalg.norm(force[:length], axis=1), faults[:length]

    def wait_for_force(self, recording):
        wait_until(lambda: self.recorded(recording)[0][-1:].sum() > FELT, "no force came")

    def wait_for_fault(self, recording, fault, since=0):
        def has_come():
            force, faults = self.recorded(recording)
            first = np.flatnonzero(faults[since:] & fault)[:1]
            return first.size > 0 and force[since + first[0] :].min() == 0

        wait_until(has_come, "the fault was not told of, or left the force")

    def assert_no_force_while(self, there, force):
        """From RAMP ticks after each beginning of a fault to its last tick and RAMP more; there[i]: in tick i."""
        self.assertTrue(there.any())
        for first in np.flatnonzero(there & ~np.r_[False, there[:-1]]):
            length = np.argmin(np.r_[there[first:], False])
            if length > RAMP:  # in a shorter one, the ramp is still on its way
                self.assertEqual(force[first + RAMP : first + length + RAMP - 1].max(), 0)

    def assert_ended_without_force(self, recording):
        force, faults = self.recorded(recording)
        stopping = np.flatnonzero(faults & SERVO_STOPPING)
        self.assertGreater(len(stopping), RAMP)
        self.assertGreater(force[stopping[0] - 1], FELT)
        self.assertTrue((np.diff(force[stopping]) <= 0).all())
        self.assertEqual(force[-1], 0)
