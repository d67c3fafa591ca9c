# SPDX-License-Identifier: GPL-3.0-or-later
"""Builds that are killed, run twice at once, or read meanwhile: an asset is whole at every moment."""
import json
import os
import pathlib
import shutil
import subprocess
import threading
import time
import unittest

import small_disk
from crash import BIN, Crashes, run


class SomeCrashes(Crashes):
    def test_killed_at_some_moments_a_build_loses_nothing_and_the_next_completes(self):
        self.try_kills(4, seed=1)

    def test_two_builds_at_once_make_one_sound_asset(self):
        both = [subprocess.Popen(self.build(), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True) for _ in range(2)]
        for process in both:
            _, said = process.communicate(timeout=200)
            self.assertEqual(process.returncode, 0, said)
        self.assertSound()
        self.assertEqual(self.left(), [])

    def test_two_builds_at_once_of_a_case_that_changes_meanwhile_make_one_of_the_two(self):
        said = []
        for modulus, cell in ((6.3, 8), (9, 9)):
            self.write_case(modulus, cell)
            said.append(subprocess.Popen(self.build(), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True))
            self.await_stage()
        for process in said:
            _, message = process.communicate(timeout=200)
            self.assertEqual(process.returncode, 0, message)
        self.assertSound()
        made = self.inspected()
        shutil.rmtree(self.folder / "case.parts")
        self.assertBuilds()
        self.assertEqual(made, self.inspected())  # of the second, which waited for the first

    def await_stage(self):
        """Until a build is at its first stage, and holds its folder."""
        end = time.monotonic() + 60
        while not list(self.folder.glob("case.parts/*.request.json")) and time.monotonic() < end:
            time.sleep(0.02)

    def test_a_build_that_is_killed_takes_its_stage_along(self):
        killed = subprocess.Popen(self.build(), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.await_stage()
        killed.kill()
        killed.wait()
        time.sleep(0.5)
        of_ours = [line for line in run("ps", "-eo", "args").stdout.splitlines() if str(self.folder) in line]
        self.assertEqual(of_ours, [])
        self.assertBuilds()

    def test_where_folders_have_no_locks_a_build_is_refused_and_the_asset_kept(self):
        self.assertBuilds()
        before = self.asset.read_bytes()
        self.write_case(9)
        plain = pathlib.Path(os.environ["PALPATE_BUILD"]) / "tests" / "plain_disk.so"
        refused = run(*self.build(), env=dict(os.environ, LD_PRELOAD=str(plain), NO_LOCKS="1"))
        self.assertEqual(refused.returncode, 1, refused.stderr)
        self.assertRegex(refused.stderr, r"case\.parts: cannot be locked: No locks available.*local disk")
        self.assertEqual(self.asset.read_bytes(), before)

    @unittest.skipUnless(os.geteuid() == 0, "mounting a small disk needs root")
    def test_a_disk_that_is_full_loses_nothing_and_the_next_build_completes(self):
        disk = small_disk.mounted(self, self.folder / "disk", "32m")
        self.asset, full = disk / "case.vtkhdf", disk / "full"
        self.assertBuilds()
        before = self.asset.read_bytes()
        for number, room in enumerate((0, 30_000, 300_000), 1):
            with self.subTest(room=room):
                self.change("cell", number)
                free = os.statvfs(disk)
                full.write_bytes(bytes(free.f_bavail * free.f_bsize - room))
                refused = run(*self.build())
                self.assertEqual(refused.returncode, 1, refused.stderr)
                self.assertRegex(refused.stderr, "No space left on device|could not be written|cannot be written")
                self.assertNotIn("/proc/self", refused.stderr)
                self.assertEqual((self.asset.read_bytes(), self.left()), (before, []))
                full.unlink()
        self.assertBuilds()

    def inspected(self):
        seen = json.loads(run(BIN / "palpate", "inspect", self.asset, "--json", "-", "--quiet").stdout)
        return {key: seen[key] for key in ("bodies", "regions", "certificates")} | {"case": seen["provenance"]["build"]["case"]}

    def test_a_reader_meanwhile_has_the_old_asset_or_the_new_one(self):
        self.assertEqual(run(*self.build()).returncode, 0)
        self.write_case(9)
        done = threading.Event()

        def build_again():
            self.rebuilt = run(*self.build())
            done.set()

        builder = threading.Thread(target=build_again)
        builder.start()
        seen = set()
        while not done.is_set():
            read = run(BIN / "palpate", "inspect", self.asset, "--json", "-", "--quiet")
            self.assertEqual(read.returncode, 0, read.stderr)
            seen |= {round(region["youngs_modulus_kpa"], 6) for region in json.loads(read.stdout)["regions"] if region["region"] == "liver"}
        builder.join()
        self.assertEqual(self.rebuilt.returncode, 0, self.rebuilt.stderr)
        self.assertIn(6.3, seen)
        self.assertLessEqual(seen, {6.3, 9})
        self.assertSound()


if __name__ == "__main__":
    unittest.main()
