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
        self.assertEqual(run(PHANTOM, "abdomen", self.folder / "abdomen.nrrd", self.folder / "truth.seg.nrrd").returncode, 0)
        self.write_case(6.3)

    def write_case(self, modulus):
        self.case.write_text(CASE.replace("youngs_modulus_kpa = 6.3", f"youngs_modulus_kpa = {modulus}"))

    def build(self):
        return [BIN / "palpate", "build", self.case, "-o", self.asset, "--force", "--quiet"]

    def kill_after(self, seconds):
        """Kills a build with all of its stages, as a power cut or the out-of-memory killer does."""
        process = subprocess.Popen(self.build(), start_new_session=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        time.sleep(seconds)
        try:
            os.killpg(process.pid, signal.SIGKILL)
        except ProcessLookupError:
            pass
        process.wait()

    def assertSound(self):
        verified = run(BIN / "palpate", "verify", self.asset, "--quiet")
        self.assertEqual(verified.returncode, 0, verified.stdout + verified.stderr)

    def try_kills(self, count, seed):
        moments = random.Random(seed)
        start = time.monotonic()
        built = run(*self.build())
        self.assertEqual(built.returncode, 0, built.stderr)
        longest = time.monotonic() - start
        for kill in range(count):
            # Another modulus each time, so that there is something to do, and an earlier asset to lose.
            self.write_case(6.3 + 0.01 * (kill + 1))
            before = self.asset.read_bytes()
            self.kill_after(moments.uniform(0, longest))
            if self.asset.read_bytes() != before:
                self.assertSound()
            if kill % 10 == 9 or kill == count - 1:
                again = run(*self.build())
                self.assertEqual(again.returncode, 0, again.stderr)
                self.assertSound()
                left = [str(p) for p in self.folder.rglob(".part*")]
                self.assertEqual(left, [], "left behind")
