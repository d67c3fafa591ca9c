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

import numpy as np

sys.path.insert(0, f"{os.environ['PALPATE_SOURCE']}/tests/commands")
from sample_asset import SampleAsset  # noqa: E402
from x_server import NEEDED, XServer  # noqa: E402

BESIDE_THE_ORGAN = 50, 300  # pixels of the sample's first view, and of its start page
SIZE = 1280, 720
TIMELINE_MARGIN = 0.017  # of the window's width, to either side of the timeline
TIMELINE = 720 - 80  # a place within it, pixels from above
STILL = 0.05  # of a channel's 255 on average: nothing moves
TRAIN = pathlib.Path(os.environ["PALPATE_BIN"]) / "palpate-train"


def pixels(dump):
    """Of an X window's dump: red, green, blue, red, ..."""
    return subprocess.run(["convert", "xwd:-", "-depth", "8", "rgb:-"], input=dump, capture_output=True, check=True).stdout


def pixels_like(rgb, is_like):
    return [i for i, pixel in enumerate(zip(rgb[0::3], rgb[1::3], rgb[2::3])) if is_like(*pixel)]


def is_head(r, g, b):  # (1, 0.85, 0.3)
    return r > 240 and 200 < g < 230 and 60 < b < 95


def is_whole(picture):
    """Whether a PNG file is there and written to its end."""
    return picture.exists() and picture.read_bytes().endswith(b"IEND\xaeB`\x82")


def difference(one, other):
    """How far two pictures of one size are apart, in a channel's 255, on average."""
    return sum(abs(a - b) for a, b in zip(one, other, strict=True)) / len(one)


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

    def head(self, window):
        """Where the timeline's head is, pixels from the left; nothing where there is none."""
        heads = pixels_like(pixels(self.screen(window)), is_head)
        columns = [i % SIZE[0] for i in heads if abs(i // SIZE[0] - TIMELINE + 7) < 4]  # between a page's lines
        return sum(columns) / len(columns) if columns else None

    def on_timeline(self, share):
        """Where a share of a recording's time lies on the timeline, pixels from the left."""
        return SIZE[0] * (TIMELINE_MARGIN + (1 - 2 * TIMELINE_MARGIN) * share)

    def wait_for(self, condition, seconds=30):
        """What the condition gives once that is true: a busy machine draws late."""
        deadline = time.monotonic() + seconds
        while not (met := condition()):
            self.assertLess(time.monotonic(), deadline, f"what was waited for did not come within {seconds} seconds")
            time.sleep(0.2)
        return met

    def shows_page(self, window):
        """Whether the dark sheet of the start page lies over the organ."""
        small = subprocess.run(["convert", "xwd:-", "-resize", "16x9!", "-depth", "8", "rgb:-"],
                               input=self.screen(window), capture_output=True, check=True).stdout
        return max(small[3 * (16 * 7 + 8):][:3]) < 60  # in column 8 and row 7, where the organ is brighter

    def leave_start_page(self, window):
        self.wait_for(lambda: self.shows_page(window))  # before it is there its keys are the window's
        self.x("xdotool", "key", "BackSpace")
        self.wait_for(lambda: not self.shows_page(window))

    def take_picture(self, *conversion):
        """Red, green, blue, red, ... of the window as it is drawn after all that was sent so far, converted so."""
        taken = lambda: list(filter(is_whole, self.folder.glob("palpate-sample-*.png")))
        before = set(taken())
        self.x("xdotool", "key", "F12")
        self.wait_for(lambda: set(taken()) - before)
        (path,) = set(taken()) - before
        rgb = subprocess.run(["convert", path, *conversion, "-depth", "8", "rgb:-"], capture_output=True, check=True).stdout
        path.unlink()
        return rgb

    def picture(self):
        """The scene so, coarse: without the grain, and without the figures at the left."""
        return self.take_picture("-gravity", "east", "-crop", "75%x50%+0+0", "+repage", "-scale", "120x45!")

    def scene(self):
        """All 1280x720 pixels so, in rows from above: (r, g, b) each."""
        return np.frombuffer(self.take_picture(), np.uint8).reshape(720, 1280, 3).astype(int)

    def come_to_rest(self):
        """Waits until what was sent so far has been done, and returns the scene's picture then."""
        pictures = [self.picture(), self.picture()]
        deadline = time.monotonic() + 30
        while difference(*pictures) > STILL:
            self.assertLess(time.monotonic(), deadline, "the scene does not come to rest")
            time.sleep(0.1)
            pictures = [pictures[1], self.picture()]
        return pictures[1]

    def finish(self, process):
        """What the trainer printed, once it has ended in order."""
        out, err = process.communicate(timeout=90)
        self.assertEqual(process.returncode, 0, err)
        return json.loads(out)

    def find_window(self):
        """The id of the trainer's window, which is drawn and has the focus, and the pointer beside the organ."""
        window = self.x("xdotool", "search", "--sync", "--onlyvisible", "--name", "Palpate: sample").split()[0]
        window = window.decode()
        deadline = time.monotonic() + 20
        while max(pixels(self.screen(window))) < 100:
            self.assertLess(time.monotonic(), deadline, "nothing was drawn")
            time.sleep(0.2)
        self.x("xdotool", "windowfocus", "--sync", window)
        self.x("xdotool", "mousemove", "--window", window, *BESIDE_THE_ORGAN)
        return window


class OpenedTrainer(TrainerCase):
    """A trainer whose start page has been left."""

    def open_window(self, *options):
        process, window = super().open_window(*options)
        self.leave_start_page(window)
        return process, window

    def close(self, process):
        self.x("xdotool", "key", "q")
        return self.finish(process)
