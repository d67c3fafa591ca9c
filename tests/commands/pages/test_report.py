# SPDX-License-Identifier: GPL-3.0-or-later
"""palpate-report: one self-contained page, and clear refusals."""
import html.parser
import json
import os
import pathlib
import shutil
import subprocess
import sys
import unittest

sys.path.insert(0, f"{os.environ['PALPATE_SOURCE']}/tests/commands")
from sample_asset import SampleAsset

BIN = pathlib.Path(os.environ["PALPATE_BIN"])
BUILD = pathlib.Path(os.environ["PALPATE_BUILD"])
PHANTOM = BUILD / "tests" / "phantom"
EMPTY = {"meta", "img", "br"}


class Page(html.parser.HTMLParser):
    """Collects sections and references, and checks that elements are nested."""

    def __init__(self):
        super().__init__()
        self.open, self.sections, self.references, self.text = [], [], [], ""

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        if tag == "section":
            self.sections.append(attributes["id"])
        self.references += [attributes[k] for k in ("src", "href", "srcset", "action") if k in attributes]
        if tag not in EMPTY:
            self.open.append(tag)

    def handle_startendtag(self, tag, attributes):
        self.handle_starttag(tag, attributes)
        if tag not in EMPTY:
            self.open.pop()

    def handle_endtag(self, tag):
        assert self.open and self.open[-1] == tag, f"</{tag}> closes {self.open[-1:]}"
        self.open.pop()

    def handle_data(self, data):
        self.text += data


@unittest.skipUnless(os.environ.get("DISPLAY") or shutil.which("Xvfb"), "PALPATE: xvfb is missing")
class Report(SampleAsset):
    writer = "write_sample_case"

    def report(self, *arguments, **options):
        return subprocess.run([BIN / "palpate-report", *map(str, arguments)], text=True, capture_output=True,
                              timeout=120, **options)

    def file(self, name, content):
        path = self.folder / name
        path.write_text(content)
        return path

    def parsed(self, path):
        page = Page()
        page.feed(path.read_text(encoding="utf-8"))
        self.assertEqual(page.open, [])
        return page

    def test_all_inputs_make_a_full_page_that_needs_nothing_else(self):
        volume, labels = self.folder / "head.nrrd", self.folder / "head.seg.nrrd"
        subprocess.run([PHANTOM, "head", volume, labels], check=True, capture_output=True)
        stages = self.file("stages.json", json.dumps([
            {"stage": "mesh wall", "seconds": 3.25, "peak_memory_bytes": 123000000},
            {"stage": "pack", "seconds": 0.5, "peak_memory_bytes": 7000000, "status": "up to date"}]))
        touch = self.file("touch.json", json.dumps({"ticks": 4000, "overruns": 2, "force_peak_n": 1.5}))
        curve = self.file("force.svg", '<svg xmlns="http://www.w3.org/2000/svg"></svg>')
        out = self.folder / "full.html"
        run = self.report(self.asset, "--volume", volume, "--labels", labels, "--touch", touch, "--curve", curve,
                          "--stages", stages, "-o", out)
        self.assertEqual(run.returncode, 0, run.stderr)
        page = self.parsed(out)
        self.assertEqual(page.sections, ["slices", "bodies", "mesh", "contract", "worst", "distances", "mechanics", "felt", "certificate", "touch", "stages",
                                         "provenance"])
        for reference in page.references:
            self.assertTrue(reference.startswith(("data:", "#")), reference[:80])
        for words in ("sample", "mesh wall", "3.25 s", "up to date", "1.5 N", "Verified"):
            self.assertIn(words, page.text)
        self.assertNotIn("was given", page.text)

    def test_the_asset_alone_names_the_options_that_add_more(self):
        out = self.folder / "bare.html"
        run = self.report(self.asset, "-o", out)
        self.assertEqual(run.returncode, 0, run.stderr)
        text = self.parsed(out).text
        for option in ("--volume", "--labels", "--touch", "--curve", "--stages"):
            self.assertIn(option, text)

    def test_equal_inputs_give_equal_bytes(self):
        one, two = self.folder / "one.html", self.folder / "two.html"
        for path in (one, two):
            self.assertEqual(self.report(self.asset, "-o", path).returncode, 0)
        self.assertEqual(one.read_bytes(), two.read_bytes())

    def test_bad_input_is_refused_and_nothing_is_left(self):
        damaged = self.file("damaged.vtkhdf", "no asset")
        no_json = self.file("no.json", "{")
        no_list = self.file("list.json", '{"stage": 1}')
        no_svg = self.file("no.svg", "hello")
        existing = self.file("there.html", "mine")
        out = self.folder / "never.html"
        cases = [
            ([damaged, "-o", out], 3, "damaged.vtkhdf"),
            ([self.folder / "missing.vtkhdf", "-o", out], 3, "missing.vtkhdf"),
            ([self.asset, "--stages", no_json, "-o", out], 3, "no.json"),
            ([self.asset, "--stages", no_list, "-o", out], 3, "list.json"),
            ([self.asset, "--touch", no_json, "-o", out], 3, "no.json"),
            ([self.asset, "--curve", no_svg, "-o", out], 3, "no.svg"),
            ([self.asset, "--labels", no_svg, "-o", out], 3, "no.svg"),
            ([self.asset, "-o", existing], 3, "--force"),
            ([self.asset], 2, "--output"),
        ]
        for arguments, code, words in cases:
            run = self.report(*arguments)
            self.assertEqual(run.returncode, code, run.stderr)
            self.assertIn(words, run.stderr)
            self.assertFalse(out.exists())
        self.assertEqual(existing.read_text(), "mine")

    def test_without_display_and_xvfb_the_package_is_named(self):
        out = self.folder / "never.html"
        run = self.report(self.asset, "-o", out, env={"PATH": "/nonexistent"})
        self.assertEqual(run.returncode, 1)
        self.assertIn("'xvfb'", run.stderr)
        self.assertFalse(out.exists())


if __name__ == "__main__":
    unittest.main()
