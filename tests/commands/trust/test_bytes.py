# SPDX-License-Identifier: Apache-2.0
"""An asset with random bytes changed is refused, or means the same."""
import unittest

from damage import DamagedBytes


class SomeBytes(DamagedBytes):
    def test_changed_are_found_or_do_not_matter(self):
        self.try_changes(50, seed=1)


if __name__ == "__main__":
    unittest.main()
