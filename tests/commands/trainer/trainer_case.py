# SPDX-License-Identifier: Apache-2.0
"""The trainer in a display of its own, driven as a person would."""
import os
import pathlib
import shutil
import subprocess
import sys
import time
import unittest

sys.path.insert(0, f"{os.environ['PALPATE_SOURCE']}/tests/commands")
from sample_asset import SampleAsset  # noqa: E402
from x_server import NEEDED, XServer  # noqa: E402

TRAIN = pathlib.Path(os.environ["PALPATE_BIN"]) / "palpate-train"


def pixels(dump):
    """Of an X window's dump: red, green, blue, red, ..."""
    return subprocess.run(["convert", "xwd:-", "-depth", "8", "rgb:-"], input=dump, capture_output=True, check=True).stdout


def yellow_pixels(dump):
    """How many pixels are as yellow as enclosed regions are drawn; the orange of notices is none."""
    rgb = pixels(dump)
    return sum(1 for r, g, b in zip(rgb[0::3], rgb[1::3], rgb[2::3]) if 1.25 * g > r > 120 and g > 100 and b < 0.6 * min(r, g))


@unittest.skipUnless(TRAIN.exists(), "PALPATE_VISUAL is off")
@unittest.skipUnless(all(map(shutil.which, NEEDED)), "PALPATE: xvfb, xdotool, x11-apps or imagemagick is missing")
class TrainerCase(SampleAsset):
    """Gives its tests `server`, in whose display the trainer runs."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.server = XServer().__enter__()
        cls.addClassCleanup(cls.server.__exit__)

    def x(self, *command):
        run = subprocess.run(
            [*map(str, command)], env=self.server.environment, check=True, capture_output=True, timeout=60
        )
        return run.stdout

    def screen(self, window):
        """What the window shows, as xwd has it."""
        return self.x("xwd", "-silent", "-id", window)

    def find_window(self):
        """The id of the trainer's window, which is drawn and has the focus and the pointer in its middle."""
        window = self.x("xdotool", "search", "--sync", "--onlyvisible", "--name", "Palpate: sample").split()[0]
        window = window.decode()
        deadline = time.monotonic() + 20
        while max(pixels(self.screen(window))) < 100:
            self.assertLess(time.monotonic(), deadline, "nothing was drawn")
            time.sleep(0.2)
        self.x("xdotool", "windowfocus", "--sync", window)
        self.x("xdotool", "mousemove", "--window", window, 640, 360)
        return window
