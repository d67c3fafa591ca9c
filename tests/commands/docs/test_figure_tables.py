# SPDX-License-Identifier: GPL-3.0-or-later
"""What test_figures.py would say of figures that do not come out again, and whether it knows every figure that is quoted."""
import unittest

from figure_sections import SECTIONS, Section
from figure_tables import FREE, Within, agree, cells
from figures import SOURCE, commands, compare, own_section, pages, quotations, remake

PAGE = """# Loops

```sh
loops.py \\
    organ  # a minute
```

| case | deep, mm | work: median / most | s |
|---|--:|--:|--:|
| organ | 1.5 | 0.12 / 0.40 % | 7 |
| organ | 3 | 12 of 40 | 7 |

## Below

| case | other |
|---|--:|
| organ | 5 |
"""


class Judge(unittest.TestCase):
    def judge(self, row, figure="0.12 %", skipped=(), everything=False, **section):
        made = cells(f"| case | deep, mm | work: median / most | s |\n|---|\n{row}\n")
        return compare(Section("", **section), own_section(PAGE, "loops"), made, [("a.md", figure)], skipped, everything)

    def test_what_comes_out_as_it_stands_is_right(self):
        self.assertEqual(self.judge("| organ | 1.5 | 0.12 / 0.40 % | 7 |").errors, [])

    def test_what_comes_out_too_far_off_is_wrong(self):
        self.assertEqual(self.judge("| organ | 1.5 | 0.13 / 0.40 % | 7 |").errors, [])  # one unit of the last digit
        self.assertIn("the page has 0.12 / 0.40 %, and it came out 0.15 / 0.40 %", self.judge("| organ | 1.5 | 0.15 / 0.40 % | 7 |").errors[0])
        self.assertIn("7", self.judge("| organ | 1.5 | 0.12 / 0.40 % | 9 |").errors[0])
        self.assertEqual(self.judge("| organ | 1.5 | 0.12 / 0.40 % | 9 |", special={"s": FREE}).errors, [])
        self.assertTrue(self.judge("| organ | 1.5 | 0.12 / 0.40 | 7 |").errors)

    def test_a_quoted_figure_that_nothing_makes_is_wrong(self):
        result = self.judge("| organ | 1.5 | 0.12 / 0.40 % | 7 |", figure="12 of 40")
        self.assertEqual(result.errors, ["a.md has 12 of 40, which no command of the section makes"])
        self.assertEqual((self.judge("| organ | 1.5 | 0.12 / 0.40 % | 7 |", "12 of 40", ["no demo"]).unmade, result.unmade), (1, 0))
        self.assertIn("nothing is said", remake("no-such-section", [("a.md", "3")]).errors[0])

    def test_a_figure_that_only_a_long_run_makes_is_told_apart(self):
        short = {"figure": "12 of 40", "at_length": ("organ, 3",)}
        result = self.judge("| organ | 1.5 | 0.12 / 0.40 % | 7 |", **short)
        self.assertEqual((result.errors, result.at_length), ([], 1))
        self.assertTrue(self.judge("| organ | 1.5 | 0.12 / 0.40 % | 7 |", **short, everything=True).errors)

    def test_two_cells_of_one_place_are_wrong(self):
        self.assertIn("more than one", self.judge("| organ | 1.5 | 0.12 / 0.40 % | 7 |\n| organ | 1.5 | 0.13 / 0.40 % | 7 |").errors[0])

    def test_figures_are_as_near_as_is_said(self):
        for said, made, within in (("5 of 10", "5 of 10", Within()), ("-2.9 %", "-2.8 %", Within()), ("3 %", "4 %", Within()), ("2e-14", "5e-14", Within(3)),
                                   ("0 / 0.2 %", "0.01 / 0.2 %", Within(slack=0.02)), ("0.2 / 9 s", "0.2 / 20 s", (Within(), Within(3))), ("950", "1 020", FREE)):
            self.assertTrue(agree(said, made, within), said)
        for said, made, within in (("0 of 100", "1 of 100", Within(2)), ("-2.9 %", "2.9 %", Within(2)), ("3 %", "5 %", Within()), ("2e-14", "7e-14", Within(3)),
                                   ("found", "none", Within(2)), ("0.2 / 9 s", "0.4 / 9 s", (Within(), Within(3)))):
            self.assertFalse(agree(said, made, within), said)

    def test_a_section_is_read_without_those_below_it(self):
        self.assertNotIn("Below", own_section(PAGE, "loops"))
        self.assertEqual([line.split() for line in commands(own_section(PAGE, "loops"), {"organ": "liver"})], ["loops.py liver # a minute".split()])


class Page(unittest.TestCase):
    def test_each_quoted_section_has_commands_and_is_known_and_no_other_is(self):
        quoted, text = quotations(), (SOURCE / pages.BENCHMARKS).read_text()
        self.assertEqual(sorted(quoted), sorted(SECTIONS))
        for name, section in SECTIONS.items():
            whole = "\n".join(commands(own_section(text, name), {}))
            self.assertTrue(whole, name)
            for words in section.shorter:
                self.assertIn(words, whole, name)
            self.assertLessEqual(set(section.at_length), {row for row, _ in cells(own_section(text, name))}, name)


if __name__ == "__main__":
    unittest.main()
