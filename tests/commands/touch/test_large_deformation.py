# SPDX-License-Identifier: Apache-2.0
"""palpate touch --large-deformation: tissue as neo-Hookean, felt, told, recorded and replayed."""

import json
import os
import pathlib
import subprocess
import sys
import unittest

import h5py

sys.path.insert(0, "..")
from sample_asset import TESTS, SampleAsset  # noqa: E402

TOUCH = pathlib.Path(os.environ["PALPATE_BIN"]) / "palpate-touch"
# Where neo-Hookean tissue is 2 % stiffer; to 8 mm it is softer by some 1 %.
PRESS = ("--script", "press", "--depth", "10", "--seconds", "2", "--virtual-clock")


class LargeDeformation(SampleAsset):
    def touch(self, *options):
        return subprocess.run([TOUCH, *map(str, options)], capture_output=True, text=True, timeout=120)

    def result(self, *options):
        run = self.touch(self.asset, *PRESS, *options, "--json", "-")
        self.assertEqual(run.returncode, 0, run.stderr)
        return json.loads(run.stdout)

    def test_a_deep_press_is_felt_otherwise_than_on_linear_tissue_and_the_result_says_of_what(self):
        linear, far = self.result(), self.result("--large-deformation", "wall")
        self.assertEqual(linear["large_deformation"], [])
        self.assertEqual(far["large_deformation"], ["wall"])
        self.assertGreater(abs(far["force_peak_n"] / linear["force_peak_n"] - 1), 0.01)
        self.assertEqual(far["force_peak_n"], self.result("--large-deformation", "all")["force_peak_n"])

    def test_a_recording_names_the_bodies_and_replays_bit_for_bit(self):
        recording = self.folder / "far.h5"
        self.result("--large-deformation", "all", "--record", recording, "--force")
        with h5py.File(recording) as run:
            self.assertEqual(run["hyperelastic"].asstr()[...].tolist(), ["wall"])
            self.assertGreater((run["ticks/detected_tick"][...] > 0).sum(), 100)
        replay = self.touch(self.asset, "--replay", recording, "--json", "-")
        self.assertEqual(replay.returncode, 0, replay.stderr)

    def test_an_asset_says_which_bodies_are_so_and_a_run_may_say_otherwise(self):
        said = self.folder / "said.vtkhdf"
        subprocess.run([TESTS / "write_sample_asset", said, "deformed_far"], check=True)
        for options, bodies in (((), ["wall"]), (("--large-deformation", "none"), []), (("--scheme", "single"), [])):
            run = self.touch(said, *PRESS, *options, "--json", "-")
            self.assertEqual(run.returncode, 0, run.stderr)
            self.assertEqual(json.loads(run.stdout)["large_deformation"], bodies, options)

    def test_what_cannot_be_is_refused_with_what_can(self):
        for options, code, words in (
            (("--large-deformation", "spleen"), 3, ("no deformable body 'spleen'", "'wall'")),
            (("--large-deformation", "none", "--large-deformation", "wall"), 2, ("'none' beside others",)),
            (("--large-deformation", "all", "--scheme", "single"), 2, ("--large-deformation", "--scheme continuous")),
        ):
            run = self.touch(self.asset, *PRESS, *options)
            self.assertEqual(run.returncode, code, run.stderr)
            for word in words:
                self.assertIn(word, run.stderr)


if __name__ == "__main__":
    unittest.main()
