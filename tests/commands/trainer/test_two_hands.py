# SPDX-License-Identifier: Apache-2.0
"""Two devices of one driver in the trainer: each is a tool, which feels what it presses."""

import unittest

import numpy as np

from trainer_case import TrainerCase
from device_run import DeviceRun
from recorded import kept

# Into the picture once the window is there, onto the soft cube, two of them 4 mm beside each other.
PRESS = [[0, 0, 0, 0], [8, 0, 0, 0], [8.5, 0, 0, -14], [100, 0, 0, -14]]
BESIDE = [[t, x + 4, y, z] for t, x, y, z in PRESS]


class TwoHands(DeviceRun, TrainerCase):
    def test_each_feels_what_it_presses(self):
        environment = self.driver({"name": "A", "path": PRESS}, {"name": "B", "path": BESIDE}, DISPLAY=self.server.environment["DISPLAY"])
        recording = self.fresh(".h5")
        self.finish(self.launch("--exercise", "free", "--attempts", self.fresh("-attempts"), "--device", "openhaptics:A,B", "--seconds", 12,
                                "--size", "640x360", "--record", recording, environment=environment))
        force, tool = np.linalg.norm(kept(recording, "ticks/force"), axis=1), kept(recording, "ticks/tool")
        place = kept(recording, "ticks/device_position")
        for held in (0, 1):
            self.assertGreater(force[tool == held].max(), 0.01)
        apart = np.linalg.norm(place[tool == 0][-1] - place[tool == 1][-1])
        self.assertAlmostEqual(apart, 4, delta=1)  # what each feels moves it a little


if __name__ == "__main__":
    unittest.main()
