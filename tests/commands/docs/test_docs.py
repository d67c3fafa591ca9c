# SPDX-License-Identifier: GPL-3.0-or-later
"""Every command block of the pages runs, in order, in one folder for each page, or says why it does not."""
import os
import pathlib
import tempfile
import unittest
from concurrent.futures import ThreadPoolExecutor

from page_blocks import BadPage, blocks_of, missing_line, same_line
from page_runner import SOURCE, Pages, Wrong

ONLY = os.environ.get("PALPATE_PAGES", "").split()  # such as docs/trainer.md, while one writes it
LEAST_BLOCKS = 35  # that run; fewer means that they were not found


def pages():
    return ["README.md", *sorted(str(page.relative_to(SOURCE)) for room in ("docs", "formats") for page in (SOURCE / room).rglob("*.md"))]


class Docs(unittest.TestCase):
    def run_pages(self, names, slow=False):
        runner = Pages(slow=slow)
        self.addCleanup(runner.close)

        def errors_of(page):
            try:
                runner.folder_of(page)
            except (BadPage, Wrong) as error:
                return [str(error)]
            return []

        with ThreadPoolExecutor(2) as pool:  # most of a block is one thread's work, or waiting for a clock
            errors = dict.fromkeys(error for found in pool.map(errors_of, names) for error in found)
        for block in sorted(runner.ran, key=str):
            print(f"ran: {block} in {block.seconds:.1f} s")
        for block, reason in sorted(runner.not_run, key=lambda row: str(row[0])):
            print(f"not run: {block}: {reason}")
        print(f"{len(runner.ran)} blocks ran, {len(runner.not_run)} did not, {len(runner.elsewhere)} have examples, which test_examples.py runs")
        self.assertFalse(errors, "\n\n".join(errors))
        return runner

    def test_every_block_runs_or_says_why_not(self):
        runner = self.run_pages(ONLY or pages())
        found = sum(len(blocks_of(page, (SOURCE / page).read_text())) for page in runner.done)
        self.assertEqual(len(runner.ran) + len(runner.not_run) + len(runner.elsewhere), found)
        self.assertTrue(ONLY or len(runner.ran) >= LEAST_BLOCKS)


class Judge(unittest.TestCase):
    """What the test above would say of pages that are wrong."""

    def judge(self, text):
        with tempfile.TemporaryDirectory() as root:
            (pathlib.Path(root) / "page.md").write_text(text)
            runner = Pages(pathlib.Path(root))
            self.addCleanup(runner.close)
            runner.folder_of("page.md")
            return runner

    def assert_wrong(self, text, said, error=Wrong):
        with self.assertRaises(error) as caught:
            self.judge(text)
        self.assertIn(said, str(caught.exception))

    def test_a_command_that_fails_is_seen_wherever_it_stands_in_a_block(self):
        self.assert_wrong("```sh\nfalse\ntrue\n```\n", "page.md:1: exit code 1")
        self.assert_wrong("```sh\npalpate inspect none.vtkhdf\n```\n", "none.vtkhdf")
        self.assert_wrong("```python\nassert False\n```\n", "AssertionError")

    def test_an_exit_code_is_the_one_that_the_page_says(self):
        self.judge("<!-- exit 4: it fails -->\n```sh\nexit 4\n```\n")
        self.assert_wrong("<!-- exit 4: it fails -->\n```sh\ntrue\n```\n", "exit code 0, expected 4")

    def test_an_output_is_the_one_that_the_page_shows(self):
        self.judge("```sh\necho 3 mm in 5 s\n```\n\n```text\n3 mm in 7 s\n```\n")
        self.assert_wrong("```sh\necho 3 mm in 5 s\n```\n\n```text\n4 mm in 5 s\n```\n", "the page says\n  4 mm in 5 s")
        self.assert_wrong("```text\nnothing before it\n```\n", "follows no command", BadPage)

    def test_what_does_not_run_has_a_reason_and_is_counted(self):
        runner = self.judge("<!-- not run: no device -->\n```sh\nfalse\n```\n\n<!-- slow: an hour -->\n```sh\nfalse\n```\n")
        self.assertEqual([reason for _, reason in runner.not_run], ["no device", "an hour"])
        self.assertEqual(runner.ran, [])
        self.assertEqual(len(self.judge("<!-- examples: another test -->\n```sh\nfalse\n```\n").elsewhere), 1)
        self.assert_wrong("<!-- not run -->\n```sh\nfalse\n```\n", "needs a reason", BadPage)
        self.assert_wrong("<!-- not run: a comment that is not just above -->\n\n```sh\nfalse\n```\n", "exit code 1")

    def test_a_window_that_does_not_open_is_seen(self):
        if self.judge("<!-- window -->\n```sh\n```\n").not_run:
            self.skipTest("xvfb or xdotool is missing")
        self.assert_wrong("<!-- window -->\n```sh\nfalse\n```\n", "no window opens")

    def test_blocks_of_a_page_share_a_folder_and_pages_that_start_from_it_have_a_copy(self):
        with tempfile.TemporaryDirectory() as root:
            (pathlib.Path(root) / "a.md").write_text("```sh\necho 1 > made\n```\n\n```sh\ncat made\n```\n")
            (pathlib.Path(root) / "b.md").write_text("<!-- starts from: a.md -->\n```sh\nrm made\n```\n")
            runner = Pages(pathlib.Path(root))
            self.addCleanup(runner.close)
            self.assertFalse((runner.folder_of("b.md") / "made").exists())
            self.assertTrue((runner.folder_of("a.md") / "made").exists())
            self.assertEqual(len(runner.ran), 3)

    def test_lines_agree_but_for_times_memory_and_last_digits(self):
        for said, printed in (("run 1.1 s", "run 27 s"), ("peak 3 MB", "peak 4.5 MB"), ("force 0.100 N", "force 0.101 N"), ("a  b", "a     b"),
                              ("residual …", "residual 3e-08"), ("… felt …", "liver tumour felt 55.6")):
            self.assertTrue(same_line(said, printed), said)
        for said, printed in (("force 0.10 N", "force 0.11 N"), ("verdict ok", "verdict bad"), ("3 slices", "30 slices"), ("p01 built", "p02 built")):
            self.assertFalse(same_line(said, printed), said)

    def test_a_line_of_dots_stands_for_any_lines_and_nothing_else_does(self):
        self.assertIsNone(missing_line("…\nb\n…\n", "a\nb\nc\n"))
        self.assertIsNone(missing_line("a\nb\n", "a\nb\n"))
        self.assertEqual(missing_line("…\nd\n", "a\nb\n"), "d")
        self.assertIn("nothing more", missing_line("a\n", "a\nb\n"))
        self.assertEqual(missing_line("b\n…\n", "a\nb\n"), "b")


if __name__ == "__main__":
    unittest.main()
