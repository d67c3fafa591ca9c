# SPDX-License-Identifier: GPL-3.0-or-later
"""Kills builds of a small case at random moments and looks at what they leave."""
import os
import pathlib
import random
import signal
import subprocess
import sys
import tempfile
import time
import unittest

sys.path.insert(0, "..")
from test_build import BIN, CASE, PHANTOM, run  # noqa: E402


class Crashes(unittest.TestCase):
    """Gives its tests `folder` with a case, never built."""

    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)
        self.asset, self.case = self.folder / "case.vtkhdf", self.folder / "case.toml"
        self.scan = self.folder / "abdomen.nrrd"
        self.assertEqual(run(PHANTOM, "abdomen", self.scan, self.folder / "truth.seg.nrrd").returncode, 0)
        self.whole_scan = self.scan.read_bytes()
        self.write_case()

    def write_case(self, modulus=6.3, cell=8):
        self.case.write_text(CASE.replace("youngs_modulus_kpa = 6.3", f"youngs_modulus_kpa = {modulus}")
                             .replace("cell_size_mm = 8", f"cell_size_mm = {cell}"))

    def change(self, what, number):
        """Makes the next build another one, from its import, its mesh or its condensation on."""
        if what == "scan":  # the same voxels in other bytes
            self.scan.write_bytes(self.whole_scan.replace(b"\n\n", b"\n# %d\n\n" % number, 1))
        else:
            self.write_case(**{what: {"modulus": 6.3, "cell": 8}[what] + 0.01 * number})

    def build(self):
        return [BIN / "palpate", "build", self.case, "-o", self.asset, "--force", "--quiet", "--virtual-clock"]

    def kill_after(self, seconds):
        """Kills a build with all of its stages, as a power cut or the out-of-memory killer does. False: it had ended."""
        process = subprocess.Popen(self.build(), start_new_session=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        time.sleep(seconds)
        at_work = process.poll() is None
        try:
            os.killpg(process.pid, signal.SIGKILL)
        except ProcessLookupError:
            pass
        process.wait()
        return at_work

    def assertSound(self):
        verified = run(BIN / "palpate", "verify", self.asset, "--quiet")
        self.assertEqual(verified.returncode, 0, verified.stdout + verified.stderr)

    def left(self):
        return [str(path) for path in self.folder.rglob(".part*")]

    def assertBuilds(self):
        start = time.monotonic()
        built = run(*self.build())
        self.assertEqual(built.returncode, 0, built.stderr)
        self.assertSound()
        self.assertEqual(self.left(), [])
        return time.monotonic() - start

    def try_kills(self, count, seed, builds_after=4):
        """Kills `count` builds at work, each with something to do and an earlier asset to lose, and lets every so many'th be
        followed by a whole one."""
        draw = random.Random(seed)
        self.assertBuilds()
        longest = {}
        for number, what in enumerate(("scan", "cell", "modulus"), 1000):
            self.change(what, number)
            longest[what] = self.assertBuilds()
        kills = number = 0
        while kills < count:
            number += 1
            what = draw.choice(sorted(longest))
            self.change(what, number)
            before = self.asset.read_bytes()
            if not self.kill_after(draw.uniform(0, longest[what])):
                continue  # it was quicker than before
            kills += 1
            self.assertEqual(self.left(), [], "left behind")
            if self.asset.read_bytes() != before:
                self.assertSound()
            if kills % builds_after == 0 or kills == count:
                self.assertBuilds()
        print(f"{kills} builds killed, {number - kills} had ended before", file=sys.stderr)
