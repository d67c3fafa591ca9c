# SPDX-License-Identifier: GPL-3.0-or-later
"""The blocks of the pages that take too long for every run."""
import unittest

import test_docs
from page_blocks import blocks_of
from page_runner import SOURCE


class SlowDocs(test_docs.Docs):
    def test_every_block_runs_or_says_why_not(self):
        slow = [page for page in test_docs.pages() if any(block.remark == "slow" for block in blocks_of(page, (SOURCE / page).read_text()))]
        self.assertTrue(slow)
        runner = self.run_pages(slow, slow=True)
        self.assertTrue(any(block.remark == "slow" for block in runner.ran))


if __name__ == "__main__":
    unittest.main()
