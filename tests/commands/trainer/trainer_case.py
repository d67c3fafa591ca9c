# SPDX-License-Identifier: Apache-2.0
"""The trainer in a display of its own, driven as a person would."""
import json
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

BESIDE_THE_ORGAN = 150, 300  # pixels of the sample's first view
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

    def launch(self, *options, environment=None, folder=None):
        """The trainer on the sample, its result going to its stdout; it does not outlive the test."""
        process = subprocess.Popen(
            [TRAIN, self.asset, "--json", "-", *map(str, options)], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
            text=True, env=environment or self.server.environment, cwd=folder or self.folder)
        self.addCleanup(process.communicate)
        self.addCleanup(process.kill)
        return process

    def open_window(self, *options):
        """The trainer and its window, on the start page unless the options say otherwise."""
        process = self.launch(*options)
        window = self.find_window()
        time.sleep(0.5)
        return process, window

    def leave_start_page(self, window):
        self.x("xdotool", "mousemove", "--window", window, *BESIDE_THE_ORGAN)
        self.x("xdotool", "key", "BackSpace")
        time.sleep(0.5)

    def finish(self, process):
        """What the trainer printed, once it has ended in order."""
        out, err = process.communicate(timeout=30)
        self.assertEqual(process.returncode, 0, err)
        return json.loads(out)

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
