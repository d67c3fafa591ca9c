# SPDX-License-Identifier: Apache-2.0
"""plot_condensation.py on figures made up by power laws, so that the crossing is known."""
import json
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree
from pathlib import Path

SCRIPT = Path(__file__).with_name("plot_condensation.py")
CROSSING = 4000  # surface nodes at which both take 10 s


def line(method, nodes, power):
    seconds = 10 * (nodes / CROSSING) ** power
    return {"method": method, "body": f"graded_{nodes}", "surface_nodes": nodes, "seconds": seconds,
            "cpu_seconds": 2 * seconds, "bytes": (2e6 if method == "exact" else 1e6) * seconds}


class PlotCondensation(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def plot(self, lines, *options):
        (self.folder / "lines.jsonl").write_text("".join(json.dumps(one) + "\n" for one in lines))
        return subprocess.run([sys.executable, SCRIPT, self.folder / "lines.jsonl", *options], text=True,
                              capture_output=True)

    def test_the_crossing_is_where_the_power_laws_meet(self):
        lines = [line("exact", nodes, 3) for nodes in (500, 2000)]  # carried on as the cube to 20 000
        lines += [line("hierarchical", nodes, 1) for nodes in (500, 2000, 20000)]
        slow_rerun = dict(lines[0], seconds=1000)
        done = self.plot([*lines, slow_rerun], "-o", self.folder / "growth.svg")
        self.assertIn("Time to build: hierarchical is faster from 4 000 nodes", done.stdout, done.stderr)
        drawn = "".join(xml.etree.ElementTree.parse(self.folder / "growth.svg").getroot().itertext())
        for words in ("equal at 4 000 nodes", "10 s", "≈ 21 min", "hierarchical", "Size in an asset", "20 000"):
            self.assertIn(words, drawn)

    def test_what_costs_less_at_every_size_is_said(self):
        lines = [line(method, nodes, 1) for nodes in (500, 20000) for method in ("exact", "hierarchical")]
        done = self.plot(lines, "-o", self.folder / "growth.svg")
        self.assertIn("Size in an asset: hierarchical is smaller at every size measured", done.stdout, done.stderr)

    def test_nothing_to_draw_is_refused(self):
        self.assertNotEqual(self.plot([line("LAPACK", 500, 3)], "-o", self.folder / "growth.svg").returncode, 0)

    def test_the_table_replaces_the_pages_and_shows_what_misses_its_limit(self):
        page = self.folder / "page.md"
        page.write_text("before\n<!-- table of bench_condensation -->\nold\n<!-- end of table -->\nafter\n")
        figure = {"figure": "MB", "body": "graded_a", "surface_nodes": 1182, "limit": "<= 50"}
        done = self.plot([dict(figure, value=12), dict(figure, body="graded_b", value=1234, met=False)], "--table", page)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(page.read_text().splitlines()[2:5], [
            "|  | limit | graded 1 182 | graded 1 182 |", "| --- | --: | --: | --: |", "| MB | ≤ 50 | 12 | **1 234** |"])


if __name__ == "__main__":
    unittest.main()
