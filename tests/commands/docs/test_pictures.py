# SPDX-License-Identifier: GPL-3.0-or-later
"""The pages' pictures of windows and of a report come out again: each taken anew is most alike to the one that the page has of it."""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

import numpy

SOURCE = pathlib.Path(os.environ["PALPATE_SOURCE"])
sys.path.insert(0, str(SOURCE / "docs/generator"))
import screens  # noqa: E402
from x_server import NEEDED  # noqa: E402

SIZE = screens.SIZES[0]
WIDE, HIGH = 128, 72  # pixels in which two are compared: what stands where, not the figures of one run


def seen(picture):
    """Its brightness, shape (HIGH, WIDE), 0 to 255."""
    grey = subprocess.run(["convert", picture, "-resize", f"{WIDE}x{HIGH}!", "-depth", "8", "gray:-"], check=True, capture_output=True).stdout
    return numpy.frombuffer(grey, numpy.uint8).reshape(HIGH, WIDE).astype(float)


def shown():
    """The picture of each name that pages have."""
    folder = screens.PICTURES / "screens" / str(SIZE[1])
    return {name: folder / f"{name}.webp" for name in screens.SCREENS} | {"report": screens.PICTURES / "report.webp"}


class Pictures(unittest.TestCase):
    def setUp(self):
        for needed in (*NEEDED, "chromium"):
            if not shutil.which(needed):
                self.skipTest(f"{needed} is absent")
        for case in ("liver.vtkhdf", "nasopharynx.vtkhdf", "nasopharynx.html"):
            if not (SOURCE / "build/demo" / case).exists():
                self.skipTest(f"build/demo/{case} is absent: pipelines/demo.sh makes it")

    def test_each_is_most_alike_to_the_one_of_its_name(self):
        pages_have = {name: seen(picture) for name, picture in shown().items()}
        for name in pages_have:
            with self.subTest(picture=name), tempfile.TemporaryDirectory() as folder:
                taken = pathlib.Path(folder) / "taken.webp"
                screens.take_report(taken) if name == "report" else screens.take_screen(name, SIZE, taken)
                now = seen(taken)
                unlike = {other: numpy.abs(now - picture).mean() for other, picture in pages_have.items()}
                first, second = sorted(unlike, key=unlike.get)[:2]
                print(f"{name}: {unlike[name]:.1f} of 255 from its own, {unlike[second if first == name else first]:.1f} from {second if first == name else first}", flush=True)
                self.assertEqual(first, name)


if __name__ == "__main__":
    unittest.main()
