# SPDX-License-Identifier: Apache-2.0
"""10 000 assets with random bytes changed: each is refused, or means the same."""
import unittest

from damage import DamagedBytes


class ManyBytes(DamagedBytes):
    def test_changed_are_found_or_do_not_matter(self):
        self.try_changes(10000, seed=2)


if __name__ == "__main__":
    unittest.main()
