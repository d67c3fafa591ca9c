# SPDX-License-Identifier: GPL-3.0-or-later
"""kill -9 at 200 random moments of a build: never an asset that opens and is wrong, never an earlier one lost."""
import unittest

from crash import Crashes


class ManyCrashes(Crashes):
    def test_killed_at_two_hundred_moments_a_build_loses_nothing(self):
        self.try_kills(200, seed=2)


if __name__ == "__main__":
    unittest.main()
