# SPDX-License-Identifier: GPL-3.0-or-later
"""Every figure that a page quotes from tests/benchmarks/README.md comes out again of the commands that stand beside it."""
import unittest

from figures import quotations, remake

LEAST_FIGURES = 40  # that are quoted; fewer means that they were not found


class Figures(unittest.TestCase):
    def test_every_quoted_figure_comes_out_again(self):
        quoted, results = quotations(), []
        self.assertGreaterEqual(sum(map(len, quoted.values())), LEAST_FIGURES)
        for name, figures in quoted.items():
            with self.subTest(section=name):
                results.append(remake(name, figures))
                print("\n".join(f"{name}: {row}" for row in (*results[-1].rows, *results[-1].skipped)), flush=True)
                self.assertFalse(results[-1].errors, "\n".join(results[-1].errors))
        at_length, unmade = (sum(getattr(result, what) for result in results) for what in ("at_length", "unmade"))
        print(f"{sum(map(len, quoted.values()))} figures are quoted; {at_length} of them are left to remake_figures.py --whole, {unmade} were not made")
        if unmade:
            self.skipTest(f"{unmade} figures were not made, for want of what is named above")


if __name__ == "__main__":
    unittest.main()
