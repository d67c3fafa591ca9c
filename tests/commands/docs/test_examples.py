# SPDX-License-Identifier: GPL-3.0-or-later
"""Every example of docs/commands.md runs by itself, in a folder with the files that it names."""
import pathlib
import tempfile
import unittest
import unittest.mock
from concurrent.futures import ThreadPoolExecutor
from graphlib import CycleError

from example_runner import Examples, NotRun
from page_runner import NEEDS, Wrong

PAGE = "docs/commands.md"
LEAST_EXAMPLES = 45  # fewer means that they were not found


class ExamplesOfThePage(unittest.TestCase):
    def test_every_example_runs_and_makes_what_it_names(self):
        runner = Examples(PAGE)
        self.addCleanup(runner.close)

        def error_of(line):
            try:
                runner.folder_of(line)
            except (NotRun, Wrong) as error:
                return error
            return None

        with ThreadPoolExecutor(2) as pool:
            errors = dict(zip(runner.examples, pool.map(error_of, runner.examples)))
        for line, error in errors.items():
            print(f"ran in {runner.examples[line].seconds:.1f} s: {line}" if error is None else f"failed: {line}" if isinstance(error, Wrong) else
                  f"not run: {line}: {error}")
        ran = list(errors.values()).count(None)
        print(f"{ran} examples ran, {len(errors) - ran} did not")
        if wrong := dict.fromkeys(str(error) for error in errors.values() if isinstance(error, Wrong)):
            self.fail("\n\n".join(wrong))
        self.assertGreaterEqual(len(errors), LEAST_EXAMPLES)

    def test_the_tables_have_nothing_that_no_example_needs(self):
        runner = Examples(PAGE)
        self.addCleanup(runner.close)
        self.assertEqual(runner.unused(), [])


class Judge(unittest.TestCase):
    """What the tests above would say of examples that are wrong."""

    def judge(self, *lines, **files):
        """Of a page with these examples, and files NAME.txt that are made so."""
        with tempfile.TemporaryDirectory() as root:
            (pathlib.Path(root) / "page.md").write_text("<!-- examples: a test -->\n```sh\n" + "\n".join(lines) + "\n```\n")
            runner = Examples("page.md", {f"{name}.txt": line for name, line in files.items()}, pathlib.Path(root))
        self.addCleanup(runner.close)
        return runner

    def test_a_line_that_fails_or_does_not_make_what_it_names_is_wrong(self):
        runner = self.judge("true", "false", "true -o made.txt", "cat made.txt")
        runner.folder_of("true")
        for line, said in (("false", "page.md:4: exit code 1"), ("true -o made.txt", "does not make made.txt"),
                           ("cat made.txt", "page.md:5: does not")):
            with self.assertRaises(Wrong) as caught:
                runner.folder_of(line)
            self.assertIn(said, str(caught.exception))

    def test_a_line_has_the_files_that_it_names_and_no_others(self):
        runner = self.judge("test $(ls) = a.txt", "cat b.txt", "test -e a.txt && test ! -e b.txt", a="echo >a.txt", b="cp a.txt b.txt")
        for line in list(runner.examples)[:2]:
            runner.folder_of(line)
        with self.assertRaises(Wrong):
            runner.folder_of("test -e a.txt && test ! -e b.txt")

    def test_what_a_line_makes_is_what_others_take(self):
        runner = self.judge("echo 1 | sort -o made.txt", "grep 1 made.txt", "echo 2 | sort -o made.txt")
        for line in runner.examples:
            runner.folder_of(line)
        with self.assertRaises(CycleError):
            self.judge("sort a.txt -o b.txt", "sort b.txt -o a.txt")

    def test_what_cannot_run_here_holds_up_what_takes_from_it(self):
        with unittest.mock.patch.dict(NEEDS, {"distil": ["a-still"]}):
            runner = self.judge("cat a.txt", a="distil >a.txt")
            with self.assertRaises(NotRun) as caught:
                runner.folder_of("cat a.txt")
        self.assertEqual(str(caught.exception), "not installed here: a-still")

    def test_what_no_example_needs_is_found(self):
        self.assertIn("a.txt", self.judge("true", a="echo >a.txt").unused())
        self.assertNotIn("a.txt", self.judge("cat a.txt", a="echo >a.txt").unused())


if __name__ == "__main__":
    unittest.main()
