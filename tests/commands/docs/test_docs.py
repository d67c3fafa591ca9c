# SPDX-License-Identifier: GPL-3.0-or-later
"""Every command block of the pages runs, in order, in one folder for each page, or says why it does not."""
import os
import pathlib
import unittest

from page_blocks import BadPage, blocks_of, missing_line, same_line
from page_runner import SOURCE, Pages, Wrong

SLOW = os.environ.get("PALPATE_SLOW_PAGES") == "1"
ONLY = os.environ.get("PALPATE_PAGES", "").split()  # such as docs/trainer.md, while one writes it


def pages():
    found = ["README.md", *sorted(str(page.relative_to(SOURCE)) for room in ("docs", "formats")
                                  for page in (SOURCE / room).rglob("*.md"))]
    return [page for page in found if not ONLY or page in ONLY]


class Docs(unittest.TestCase):
    def test_every_block_runs_or_says_why_not(self):
        runner = Pages(slow=SLOW)
        self.addCleanup(runner.close)
        for page in pages():
            with self.subTest(page):
                try:
                    runner.folder_of(page)
                except (BadPage, Wrong) as error:
                    self.fail(str(error))
        for block in runner.ran:
            print(f"ran: {block} in {block.seconds:.1f} s")
        for block, reason in runner.not_run:
            print(f"not run: {block}: {reason}")
        print(f"{len(runner.ran)} blocks ran, {len(runner.not_run)} did not")
        if not ONLY:
            self.assertGreater(len(runner.ran), 40)


if __name__ == "__main__":
    unittest.main()
