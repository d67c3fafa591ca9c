# SPDX-License-Identifier: GPL-3.0-or-later
"""Builds that are killed, run twice at once, or read meanwhile: an asset is whole at every moment."""
import json
import subprocess
import threading
import unittest

from crash import BIN, Crashes, run


class SomeCrashes(Crashes):
    def test_killed_at_some_moments_a_build_loses_nothing_and_the_next_completes(self):
        self.try_kills(3, seed=1)

    def test_two_builds_at_once_make_one_sound_asset(self):
        both = [subprocess.Popen(self.build(), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True) for _ in range(2)]
        for process in both:
            _, said = process.communicate(timeout=200)
            self.assertEqual(process.returncode, 0, said)
        self.assertSound()
        self.assertEqual(list(self.folder.rglob(".part*")), [])

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
