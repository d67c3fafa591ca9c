# SPDX-License-Identifier: Apache-2.0
"""Ambient occlusion, which a graphics card draws in the trainer: a crease gets less light, an open wall keeps it."""
import os
import pathlib
import shutil
import subprocess
import sys
import unittest

sys.path.insert(0, "..")
from x_server import XServer  # noqa: E402

DRAW = pathlib.Path(os.environ["PALPATE_BUILD"]) / "tests/draw_crease"


@unittest.skipUnless(shutil.which("Xvfb"), "Xvfb is absent")
class Occlusion(unittest.TestCase):
    def test_a_crease_gets_less_light(self):
        with XServer() as server:
            said = subprocess.run([DRAW], env=server.environment, check=True, capture_output=True, text=True, timeout=60).stdout
        even, occluded, drawn_by = said.splitlines()
        crease, wall = map(float, even.split())
        self.assertEqual(crease, wall)
        crease_then, wall_then = map(float, occluded.split())
        self.assertLess(crease_then, 0.8 * crease)
        self.assertGreater(wall_then, 0.9 * wall)
        self.assertEqual(drawn_by, "software")  # of an Xvfb: the trainer does not offer it there


if __name__ == "__main__":
    unittest.main()
