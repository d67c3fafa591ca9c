# SPDX-License-Identifier: GPL-3.0-or-later
"""The demo's two cases, built from real volumes, verified, pressed, and judged by a direct sparse solve."""
import csv
import json
import os
import pathlib
import shutil
import subprocess
import tempfile
import tomllib
import unittest

from drawn_out import draw_out
from x_server import NEEDED, XServer

BIN = pathlib.Path(os.environ["PALPATE_BIN"])
SOURCE = pathlib.Path(os.environ["PALPATE_SOURCE"])
ORACLE = pathlib.Path(os.environ["PALPATE_BUILD"]) / "tests" / "press_oracle"
VTK_SUMMARY = pathlib.Path(os.environ["PALPATE_BUILD"]) / "tests" / "vtk_summary"
SAMPLES = SOURCE / "build" / "sample_data"
KEPT = pathlib.Path(os.environ["PALPATE_BUILD"]) / "tests" / "demo_cases"  # for commands.demo_exercises

UNSETTLED_SHARE = 0.004  # of a slide's ticks; 0.001 measured
FORCE_TOLERANCE = 0.01  # relative; what a press may differ from the direct solve


def run(*arguments):
    return subprocess.run(list(map(str, arguments)), text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=250)


@unittest.skipUnless(SAMPLES.exists(), "PALPATE sample volumes are absent; run sample_data/unpack.py")
class DemoCases(unittest.TestCase):
    def check(self, name, and_then=None):
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            (KEPT / f"{name}.vtkhdf").unlink(missing_ok=True)
            asset, log, touch = folder / "case.vtkhdf", folder / "log.csv", folder / "touch.json"
            build = [BIN / "palpate", "build", SOURCE / "pipelines" / "cases" / f"{name}.toml", "-o", asset]
            built = run(*build)
            self.assertEqual(built.returncode, 0, built.stderr)
            again = run(*build, "--json", "-")
            self.assertEqual([row["stage"] for row in json.loads(again.stdout)["stages"] if row["status"] == "run"], [])

            verified = run(BIN / "palpate", "verify", asset, "--json", "-")
            self.assertEqual(verified.returncode, 0, verified.stdout)

            inspected = json.loads(run(BIN / "palpate", "inspect", asset, "--json", "-").stdout)
            self.assertEqual([(row["region"], row["verdict"]) for row in inspected["felt"]], [("tumour", "felt")])
            self.assertTrue(any("'tumour' is made up" in caution for caution in inspected["provenance"]["build"]["cautions"]))

            seen = json.loads(run(VTK_SUMMARY, asset).stdout)
            self.assertEqual(len(seen["tetrahedra_of_region"]), 2, "organ and tumour")
            self.assertEqual(set(seen["cells_of_type"]), {"5", "10"}, "triangles and tetrahedra")

            touched = run(BIN / "palpate", "touch", asset, "--script", "press", "--depth", "3", "--seconds", "2",
                          "--virtual-clock", "--log", log, "--json", touch)
            self.assertEqual(touched.returncode, 0, touched.stderr)
            self.check_force_follows_depth(log)
            judged = run(ORACLE, asset, touch)
            self.assertEqual(judged.returncode, 0, judged.stderr)
            judgement = json.loads(judged.stdout)
            self.assertGreater(judgement["felt_n"], 0)
            self.assertLess(abs(judgement["felt_n"] / judgement["exact_n"] - 1), FORCE_TOLERANCE)
            self.assertGreaterEqual(judgement["smallest_exact_n"], 0)
            self.assertLess(judgement["deepest_inside_mm"], 0.01)
            # Loads far apart count as points in a tick: 0.004 mm on the liver.
            self.assertLess(judgement["felt_residual_mm"], 0.01)
            self.check_slide_comes_to_rest(asset)
            if and_then:
                and_then(asset, folder)
            KEPT.mkdir(parents=True, exist_ok=True)
            shutil.copy(asset, KEPT / f"{name}.vtkhdf")

    def check_slide_comes_to_rest(self, asset):
        """But where it slips over an edge, whose saddle the search for an equilibrium is not to stay at."""
        slid = json.loads(run(BIN / "palpate", "touch", asset, "--script", "slide", "--virtual-clock", "--json", "-").stdout)
        self.assertGreater(slid["force_peak_n"], 0.05)
        self.assertLess(slid["statuses"].get("contact_unsettled", 0), UNSETTLED_SHARE * slid["ticks"])

    def check_force_follows_depth(self, log):
        """Up to the first rest at full depth force never falls; at the end of the release it is zero."""
        with open(log, newline="") as file:
            rows = [{key.split("_")[0] + "_" + key.split("_")[1] if key.startswith("force") else key: float(value)
                     for key, value in row.items() if key.startswith("force") or key == "depth_mm"}
                    for row in csv.DictReader(file)]
        magnitude = [sum(value * value for key, value in row.items() if key.startswith("force")) ** 0.5 for row in rows]
        depth = [row["depth_mm"] for row in rows]
        deepest = depth.index(max(depth))
        self.assertAlmostEqual(max(depth), 3.0, delta=0.02)
        pressing = magnitude[:deepest + 1]
        # A tool deeper than its own radius rolls over edges of the mesh: half a hundredth of the peak at most.
        self.assertTrue(all(b >= a - 5e-3 * max(pressing) for a, b in zip(pressing, pressing[1:])), "force fell while pressing")
        released = next(index for index in range(deepest, len(depth)) if depth[index] == 0)
        self.assertEqual(magnitude[released + 25], 0, "a force stayed after release")

    def lead_through_the_nose(self, asset, folder):
        """The exercise that comes with the case, in a real window: by a good hand, one that scrapes along, and an idle one."""
        if not (BIN / "palpate-train").exists() or not all(map(shutil.which, NEEDED)):
            self.skipTest("PALPATE: the trainer, xvfb, xdotool, x11-apps or imagemagick is missing; all but the trainer was tested")
        exercises = SOURCE / "pipelines" / "exercises" / "nasopharynx.toml"
        (scope,) = [row for row in tomllib.loads(exercises.read_text())["exercise"] if row["name"] == "scope"]
        gates = scope["places_mm"]
        outside = [p + away for p, away in zip(gates[0], (-6, -9, -6))]
        through = [(0.6 * (i + 1), *gate) for i, gate in enumerate(gates)]
        scraping = [(1.4 * i + dt, x + aside, y, z) for i, (x, y, z) in enumerate(gates)  # into what is beside each gate
                    for dt, aside in ((0.6, 0), (1.0, 12), (1.4, 0))]
        with XServer() as server:
            def lead(*rows):
                hand = folder / "hand.txt"
                hand.write_text("\n".join(" ".join(f"{value:.3f}" for value in row) for row in ((0, *outside), *rows)))
                train = subprocess.run(
                    [BIN / "palpate", "train", asset, "--exercises", exercises, "--exercise", "scope", "--script", hand, "--seconds",
                     str(rows[-1][0] + 1), "--attempts", folder / "attempts", "--quiet", "--json", "-"],
                    capture_output=True, text=True, timeout=120, env=server.environment)
                self.assertEqual(train.returncode, 0, train.stderr)
                (attempt,) = json.loads(train.stdout)["attempts"]
                return attempt["ending"], attempt["metrics"]

            ending, good = lead(*through)
            self.assertEqual(ending, "all reached")
            self.assertGreater(good["score"], 95)
            self.assertLess(good["peak_force_n"], scope["most_force_n"])
            self.assertLess(good["position_error_mm"], 1)
            ending, clumsy = lead(*scraping)
            self.assertEqual(ending, "all reached")
            self.assertLess(clumsy["score"], 60)
            self.assertGreater(clumsy["time_above_limit_s"], 0.2)
            ending, idle = lead((2, *outside))
            self.assertEqual((ending, idle["score"]), ("cut short", 0))

    def test_nasopharynx(self):
        self.check("nasopharynx", self.lead_through_the_nose)

    def draw_the_rim_out(self, asset, folder):
        """By 20 mm: a forceps holds it to the end, without a step of force, whatever the tissue is like."""
        for tissue in ("none", "liver"):
            with self.subTest(large_deformation=tissue):
                drawn = draw_out(BIN, asset, folder, 20, "--large-deformation", tissue)
                self.assertIsNone(drawn.lost)
                self.assertGreater(drawn.pull, 0.5)
                self.assertGreater(drawn.pull, 0.99 * drawn.most)
                self.assertLess(drawn.step, 0.03 * drawn.pull)

    def find_its_exercises(self, asset, folder):
        """Those that come with the case are offered from beside the asset, each with room on this liver."""
        if not (BIN / "palpate-train").exists() or not shutil.which("Xvfb"):
            self.skipTest("PALPATE: the trainer or xvfb is missing; all but the trainer was tested")
        shutil.copy(SOURCE / "pipelines" / "exercises" / "liver.toml", asset.with_name(f"{asset.stem}-exercises.toml"))
        with XServer() as server:
            for held, offered in (((), "touch, find, trace, free"), (("--instrument", "forceps"), "retract, free")):
                train = subprocess.run([BIN / "palpate", "train", asset, "--exercise", "none", "--attempts", folder / "attempts", *held],
                                       capture_output=True, text=True, timeout=120, env=server.environment)
                self.assertEqual(train.returncode, 2, train.stderr)
                self.assertIn(f"no exercise 'none' (expected {offered})", train.stderr)

    def test_liver(self):
        self.check("liver", lambda *made: (self.draw_the_rim_out(*made), self.find_its_exercises(*made)))


if __name__ == "__main__":
    unittest.main()
