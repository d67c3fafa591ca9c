# SPDX-License-Identifier: GPL-3.0-or-later
"""Reports and a cohort's page in a browser: every picture is there, and its console has nothing to say."""
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, f"{os.environ['PALPATE_SOURCE']}/tests/commands")
import browser
from small_cohort import SmallCohort  # noqa: E402

BIN = pathlib.Path(os.environ["PALPATE_BIN"])


@unittest.skipUnless(browser.CHROMIUM, "PALPATE: chromium is missing")
class Pages(SmallCohort):
    def assert_whole(self, page, least):
        widths, console = browser.look_at(page)
        self.assertGreaterEqual(len(widths), least, page.name)
        self.assertGreater(min(widths), 1, page.name)
        self.assertEqual(console, [], page.name)

    def test_of_a_cohort_and_its_patients_are_whole(self):
        self.write_table(("one", "inputs/case.toml", "inputs/good.seg.nrrd", "", ""), ("two", "inputs/case.toml", "inputs/good.seg.nrrd", "4", ""))
        self.batch()
        self.assert_whole(self.out / "index.html", 2)
        for patient in ("one", "two"):
            (report,) = self.out.rglob(f"{patient}.html")
            self.assert_whole(report, 5)


@unittest.skipUnless(browser.CHROMIUM, "PALPATE: chromium is missing")
class Judge(unittest.TestCase):
    def test_sees_what_is_missing(self):
        with tempfile.TemporaryDirectory() as folder:
            page = pathlib.Path(folder) / "broken.html"
            page.write_text('<html><body><img src="nowhere.png"><svg><image href="data:image/png;base64,AAAA"/></svg>'
                            "<script>nonsense()</script></body></html>")
            widths, console = browser.look_at(page)
            self.assertEqual(widths, [0, 0])
            self.assertTrue(any("nonsense is not defined" in line for line in console), console)


if __name__ == "__main__":
    unittest.main()
