# SPDX-License-Identifier: GPL-3.0-or-later
"""palpate build from a phantom to asset and report: what runs again when, and what happens when something is wrong."""
import html
import json
import os
import pathlib
import re
import resource
import shutil
import signal
import subprocess
import tempfile
import time
import unittest

BIN = pathlib.Path(os.environ["PALPATE_BIN"])
PHANTOM = pathlib.Path(os.environ["PALPATE_BUILD"]) / "tests" / "phantom"

CASE = """schema = 1
name = "abdomen"
[input]
volume = "abdomen.nrrd"
labels = "truth.seg.nrrd"
[[structure]]
name = "liver"
recipe = "import"
[[structure]]
name = "tumour"
recipe = "import"
[[structure]]
name = "spine"
recipe = "import"
[[rigid]]
name = "spine"
[[deformable]]
name = "liver"
mesh = { cell_size_mm = 8, facet_size_mm = 7 }
fixed = [{ plane_mm = [0, 8, 0, 0, 1, 0] }]
[[deformable.region]]
label = "liver"
youngs_modulus_kpa = 6.3
poissons_ratio = 0.45
[[deformable.region]]
label = "tumour"
youngs_modulus_kpa = 30
poissons_ratio = 0.45
[haptics]
tool_radius_mm = 4
"""


def run(*arguments, **options):
    return subprocess.run(list(map(str, arguments)), text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          timeout=200, **options)


class Build(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.temporary.cleanup)
        cls.prepared = pathlib.Path(cls.temporary.name) / "prepared"
        cls.prepared.mkdir()
        made = run(PHANTOM, "abdomen", cls.prepared / "abdomen.nrrd", cls.prepared / "truth.seg.nrrd")
        assert made.returncode == 0, made.stderr
        (cls.prepared / "case.toml").write_text(CASE)
        built = cls.build_in(cls.prepared)
        assert built.returncode == 0, built.stderr
        cls.first = json.loads((cls.prepared / "result.json").read_text())

    @classmethod
    def build_in(cls, folder, *arguments, **options):
        """By the virtual clock, for a press by the real one waits four seconds; what is interrupted presses by that."""
        (folder / "result.json").unlink(missing_ok=True)
        return run(BIN / "palpate", "build", folder / "case.toml", "-o", folder / "case.vtkhdf",
                   "--json", folder / "result.json", "--virtual-clock", *arguments, **options)

    def setUp(self):
        # A copy of the finished build; moving a build does not make it stale.
        self.folder = pathlib.Path(self.temporary.name) / self.id().rsplit(".", 1)[1]
        shutil.copytree(self.prepared, self.folder)

    def change(self, old, new):
        case = self.folder / "case.toml"
        text = case.read_text()
        self.assertIn(old, text)
        case.write_text(text.replace(old, new))

    def stages_run(self, *arguments):
        built = self.build_in(self.folder, *arguments)
        self.assertEqual(built.returncode, 0, built.stderr)
        result = json.loads((self.folder / "result.json").read_text())
        return [row["stage"] for row in result["stages"] if row["status"] == "run"]

    def fail(self, code, *phrases, arguments=(), **options):
        built = self.build_in(self.folder, *arguments, **options)
        self.assertEqual(built.returncode, code, built.stderr)
        for phrase in phrases:
            self.assertIn(phrase, built.stderr)
        self.assert_nothing_partial()
        return built

    def assert_nothing_partial(self):
        partial = [path.name for path in self.folder.rglob(".part*")]
        self.assertEqual(partial, [], "a partial output was left behind")

    def test_first_build_runs_every_stage_and_leaves_asset_and_report(self):
        self.assertTrue(all(row["status"] == "run" for row in self.first["stages"]))
        names = [row["stage"] for row in self.first["stages"]]
        self.assertEqual(names, ["import volume", "import labels", "segment", "surface spine",
                                 "mesh liver", "condense liver", "pack", "touch", "report"])
        self.assertTrue((self.folder / "case.vtkhdf").exists())
        self.assertIn("</html>", (self.folder / "case.html").read_text())

    def test_nothing_changed_runs_no_stage(self):
        self.assertEqual(self.stages_run(), [])

    def test_a_stage_is_repeated_by_the_request_that_the_build_left(self):
        request = self.folder / "case.parts" / "surface-spine.request.json"
        self.assertEqual(set(json.loads(request.read_text())), {"labels", "label", "output"})
        again = self.folder / "again.vtp"
        repeated = run(BIN / "palpate-surface", "--request", request, "-o", again)
        self.assertEqual(repeated.returncode, 0, repeated.stderr)
        self.assertEqual(again.read_bytes(), (self.folder / "case.parts" / "spine.vtp").read_bytes())

    def test_a_body_that_hangs_is_told_by_build_report_and_asset(self):
        self.change("fixed = [{ plane_mm = [0, 8, 0, 0, 1, 0] }]", "fixed = [{ plane_mm = [0, 16, 0, 0, 1, 0] }]")
        self.change("youngs_modulus_kpa = 6.3", "youngs_modulus_kpa = 0.5")
        built = self.build_in(self.folder)
        self.assertEqual(built.returncode, 0, built.stderr)
        self.assertRegex(built.stderr, "‘liver’ hangs: 0.1 N spread over it moves it by .* mm around .*; hold it there too")
        self.assertRegex((self.folder / "case.html").read_text(), "‘liver’ hangs: 0.1 N")
        seen = run(BIN / "palpate", "inspect", self.folder / "case.vtkhdf", "--json", "-")
        self.assertRegex(json.loads(seen.stdout)["provenance"]["notes"][-1], "^‘liver’ hangs")

    def test_bone_within_a_soft_body_is_told_by_build_and_asset(self):
        self.change('[[rigid]]\nname = "spine"\n', '[[deformable]]\nname = "spine"\nmesh = { cell_size_mm = 8 }\n'
                    'fixed = [{ plane_mm = [0, 30, 0, 0, 1, 0] }]\n[[deformable.region]]\nlabel = "spine"\ntissue = "liver"\n')
        for stage in ("mesh spine", "condense spine", "pack"):
            built = self.build_in(self.folder, "--stage", stage)
            self.assertEqual(built.returncode, 0, built.stderr)
        self.assertRegex(built.stderr, r"‘spine’ holds .* ml \(\d+ %\) of 300 HU and more, .*; look at its slices, and leave that out")
        seen = run(BIN / "palpate", "inspect", self.folder / "case.vtkhdf", "--json", "-")
        self.assertRegex(json.loads(seen.stdout)["provenance"]["notes"][-1], "^‘spine’ holds .* elsewhere.$")

    def test_an_asset_s_case_is_built_again_elsewhere_to_the_same_bytes(self):
        there = self.folder / "there"
        there.mkdir()
        shutil.move(self.folder / "case.vtkhdf", there / "original.vtkhdf")
        shutil.move(self.folder / "truth.seg.nrrd", there / "labels.seg.nrrd")  # as the case calls it
        shutil.move(self.folder / "abdomen.nrrd", there / "scan.nrrd")
        again = there / "again.vtkhdf"
        command = [BIN / "palpate", "build", there / "original.vtkhdf", "-o", again, "--virtual-clock",
                   "--json", there / "result.json"]
        missing = run(*command)
        self.assertEqual(missing.returncode, 3)
        self.assertIn(f"{there / 'volume.nrrd'}: is not there", missing.stderr)
        built = run(*command, "--volume", there / "scan.nrrd")
        self.assertEqual(built.returncode, 0, built.stderr)
        self.assertEqual(json.loads((there / "result.json").read_text())["again"],
                         {"original": str(there / "original.vtkhdf"), "different": []})
        self.assertEqual(again.read_bytes(), (there / "original.vtkhdf").read_bytes())
        (there / "result.json").unlink()
        with_two = subprocess.run([BIN / "palpate", "build", self.folder / "case.toml", "--set", "input.volume=there/scan.nrrd", "--set",
                                   "input.labels=there/labels.seg.nrrd", "--set", "name=liver 3/4", "-o", there / "two.vtkhdf", "--virtual-clock", "--threads", "2"],
                                  cwd=self.folder, capture_output=True, text=True, timeout=200)
        self.assertEqual(with_two.returncode, 0, with_two.stderr)
        itself = run(BIN / "palpate", "build", there / "two.vtkhdf", "--volume", there / "scan.nrrd", "-o", there / "two.vtkhdf")
        self.assertEqual(itself.returncode, 2)
        self.assertIn("is the asset that is to be built again", itself.stderr)
        self.assertEqual(run(BIN / "palpate", "build", there / "two.vtkhdf", "--volume", there / "scan.nrrd", "-o", there / "two_again.vtkhdf",
                             "--virtual-clock").returncode, 0)
        self.assertEqual((there / "two_again.vtkhdf").read_bytes(), (there / "two.vtkhdf").read_bytes())
        with (there / "scan.nrrd").open("r+b") as scan:
            scan.seek(-2, 2)
            scan.write(b"\0\1")
        changed = run(*command, "--volume", there / "scan.nrrd")
        self.assertEqual(changed.returncode, 0, changed.stderr)
        self.assertIn("was built of: volume", changed.stderr)
        self.assertNotIn("again", json.loads((there / "result.json").read_text()))

    def test_another_modulus_reruns_only_from_condensation_on(self):
        self.change("youngs_modulus_kpa = 6.3", "youngs_modulus_kpa = 7")
        self.assertEqual(self.stages_run(), ["condense liver", "pack", "touch", "report"])

    def test_what_cannot_be_felt_is_warned_of_by_every_build_with_what_to_try(self):
        self.change("youngs_modulus_kpa = 30", "youngs_modulus_kpa = 6.6")
        for attempt in ("run", "up to date"):
            built = self.build_in(self.folder)
            self.assertEqual(built.returncode, 0, built.stderr)
            warnings = [line for line in built.stderr.splitlines() if "cannot be felt" in line]
            self.assertEqual(len(warnings), 1, attempt)
            for phrase in ("'tumour' of 'liver' cannot be felt with this tool", "where a hand tells 15 %", "; try it ",
                           "half as deep", "2 times as stiff", "1.5 times as large", "a tool of 2 mm radius"):
                self.assertIn(phrase, warnings[0])
            pack = next(row for row in json.loads((self.folder / "result.json").read_text())["stages"] if row["stage"] == "pack")
            self.assertEqual(pack["status"], attempt)
            self.assertEqual([(row["region"], row["verdict"]) for row in pack["result"]["felt"]], [("tumour", "too faint")])

    def test_another_contact_surface_or_nodes_file_reruns_only_from_condensation_on(self):
        nodes = self.folder / "doe_john.txt"
        nodes.write_text("0\n")
        self.change("fixed = [", 'contact = [{ plane_mm = [0, 0, 0, 0, -1, 0] }]\nfixed = [{ nodes_file = "doe_john.txt" }, ')
        self.assertEqual(self.stages_run(), ["condense liver", "pack", "touch", "report"])
        condensed = [json.loads((folder / "case.parts" / "condense-liver.json").read_text())
                     for folder in (self.prepared, self.folder)]
        self.assertLess(condensed[1]["contact_nodes"], condensed[0]["contact_nodes"])
        self.assertEqual(condensed[1]["fixed_nodes"], condensed[0]["fixed_nodes"] + 1)
        self.assertNotIn(b"doe_john", (self.folder / "case.vtkhdf").read_bytes())

        self.assertEqual(self.stages_run(), [])
        nodes.write_text("0\n1\n")
        self.assertEqual(self.stages_run(), ["condense liver", "pack", "touch", "report"])
        nodes.write_text("0\nx\n")
        self.fail(3, "doe_john.txt:2", "'x' is not the index of a node")
        nodes.unlink()
        self.fail(3, "doe_john.txt")

    def test_another_tool_reruns_only_from_packing_on(self):
        self.change("tool_radius_mm = 4", "tool_radius_mm = 3")
        self.assertEqual(self.stages_run(), ["pack", "touch", "report"])

    def test_a_value_that_is_set_goes_before_the_case_files_own(self):
        setting = ("--set", "deformable.liver.region.liver.youngs_modulus_kpa=7")
        self.assertEqual(self.stages_run(*setting), ["condense liver", "pack", "touch", "report"])
        self.assertEqual(self.stages_run(*setting), [])
        moved = self.folder / "elsewhere"
        moved.mkdir()
        shutil.move(self.folder / "abdomen.nrrd", moved)
        self.assertEqual(self.stages_run(*setting, "--set", f"input.volume={moved / 'abdomen.nrrd'}"), [])
        self.fail(3, "--set:1", "did you mean tool_radius_mm", arguments=("--set", "haptics.tool_radios_mm=3"))
        self.fail(2, "KEY=VALUE", arguments=("--set", "haptics"))

    def test_one_stage_runs_alone(self):
        self.change("youngs_modulus_kpa = 6.3", "youngs_modulus_kpa = 7")
        self.assertEqual(self.stages_run("--stage", "condense liver"), ["condense liver"])
        self.assertEqual(self.stages_run("--stage", "condense liver"), [])
        self.assertEqual(self.stages_run(), ["pack", "touch", "report"])
        self.fail(2, "'condense liver'", arguments=("--stage", "condense"))

    def test_one_stage_that_failed_on_its_input_is_not_tried_again(self):
        self.change("[haptics]", "[quality]\nmin_dihedral_deg = 80\n[haptics]")
        request = self.folder / "case.parts" / "mesh-liver.request.json"
        self.fail(4, "dihedral", arguments=("--stage", "mesh liver"))
        request.unlink()
        again = self.fail(4, "as before: ", arguments=("--stage", "mesh liver"))
        self.assertFalse(request.exists(), again.stderr)

    def test_other_seeds_segment_anew(self):
        seeds = self.folder / "muscle.fcsv"
        seeds.write_text("# CoordinateSystem = LPS\n1,34,20,0\n")
        case = self.folder / "case.toml"
        case.write_text(case.read_text() + '[[structure]]\nname = "muscle"\nrecipe = "grow-from-seeds"\n'
                                           'seeds_file = "muscle.fcsv"\n')
        self.assertIn("segment", self.stages_run())
        self.assertEqual(self.stages_run(), [])
        seeds.write_text("# CoordinateSystem = LPS\n1,34,22,0\n")
        self.assertIn("segment", self.stages_run())

    def test_verify_accepts_the_asset(self):
        verified = run(BIN / "palpate", "verify", self.folder / "case.vtkhdf")
        self.assertEqual(verified.returncode, 0, verified.stderr + verified.stdout)

    def test_no_path_or_file_name_of_the_input_reaches_the_asset(self):
        content = (self.folder / "case.vtkhdf").read_bytes()
        for secret in (str(self.prepared), "abdomen.nrrd", "truth.seg"):
            self.assertNotIn(secret.encode(), content)

    def test_missing_volume_is_named(self):
        (self.folder / "abdomen.nrrd").unlink()
        self.fail(3, "abdomen.nrrd")

    def test_unknown_label_lists_the_nearest_names(self):
        self.change('name = "tumour"\nrecipe = "import"', 'name = "tumour"\nrecipe = "import"\nlabel = "tumor"')
        self.fail(3, "tumor", "tumour")

    def test_unknown_key_names_line_and_suggestion(self):
        self.change("tool_radius_mm", "tool_radios_mm")
        built = self.fail(3, "did you mean tool_radius_mm")
        self.assertRegex(built.stderr, r"case\.toml:\d+")

    def test_mistakes_of_the_case_are_all_told_before_the_first_stage(self):
        self.change("fixed = [{ plane_mm = [0, 8, 0, 0, 1, 0] }]\n", "")
        self.change('label = "tumour"', 'label = "tumor"')
        built = self.fail(3, "has 2 mistakes", "'fixed' of deformable is missing", "nearest names: 'tumour'")
        self.assertNotIn("import", built.stderr)

    def test_implausible_values_are_questioned_and_kept_with_the_asset(self):
        self.change("youngs_modulus_kpa = 30", "youngs_modulus_kpa = 30000")
        built = self.build_in(self.folder)
        self.assertEqual(built.returncode, 0, built.stderr)
        self.assertIn("30000 kPa is implausible", built.stderr)
        self.assertIn("30000 kPa is implausible", (self.folder / "case.html").read_text())

    def test_unmet_quality_contract_exits_with_4(self):
        self.change("[haptics]", "[quality]\nmin_dihedral_deg = 80\n[haptics]")
        self.fail(4, "dihedral", "failure.html shows what there is so far")

    def test_a_page_shows_what_there_was_before_a_stage_failed(self):
        page = self.folder / "case.parts" / "failure.html"
        self.assertFalse(page.exists(), "nothing failed yet")
        self.change("[haptics]", "[quality]\nmin_dihedral_deg = 80\n[haptics]")
        self.fail(4)
        text = page.read_text()
        said = html.unescape(re.search(r"Not built</strong><div>(.*?)</div>", text, re.DOTALL).group(1))
        self.assertTrue(said.startswith("palpate-mesh: "), said)
        self.assertIn("dihedral", said)
        # Three planes through the image and through each structure, and what the stages before took.
        slices, stages = text.split('id="stages"')
        structures = re.findall(r"<h3>(.*?)</h3>", slices)
        self.assertEqual(structures, ["liver", "tumour", "spine"])
        self.assertEqual(slices.count("data:image/png;base64,"), 3 + 3 * len(structures))
        self.assertIn("surface spine", stages)
        self.assertNotIn("mesh liver", stages)
        self.change("min_dihedral_deg = 80", "min_dihedral_deg = 1")
        self.assertIn("mesh liver", self.stages_run())
        self.assertFalse(page.exists(), "the build did not fail any more")

    def test_a_failed_import_is_shown_without_an_image(self):
        (self.folder / "abdomen.nrrd").write_text("NRRD0004\nnonsense\n\n")
        self.fail(3)
        text = (self.folder / "case.parts" / "failure.html").read_text()
        self.assertIn("palpate-import: ", text)
        self.assertNotIn("data:image/png", text)

    def test_somebody_elses_output_is_not_replaced(self):
        (self.folder / "case.vtkhdf").write_text("precious")
        self.fail(3, "exists", "--force")
        self.assertEqual((self.folder / "case.vtkhdf").read_text(), "precious")

    def test_full_disk_fails_cleanly_in_every_writing_stage(self):
        shutil.rmtree(self.folder / "case.parts")
        for stage, limit in (("import", 20_000), ("mesh", 300_000), ("pack", 700_000), ("report", None)):
            with self.subTest(stage=stage):
                # Files larger than the limit cannot be written, as on a full disk.
                if limit is None:  # just short of the page
                    limit = (self.folder / "case.html").stat().st_size - 1000
                built = self.build_in(self.folder, "--force",
                                      preexec_fn=lambda size=limit: (signal.signal(signal.SIGXFSZ, signal.SIG_IGN),
                                                                     resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))))
                self.assertEqual(built.returncode, 1, built.stderr)
                self.assert_nothing_partial()

    def test_interrupt_in_any_stage_leaves_nothing_partial(self):
        for stage in ("import volume", "segment", "mesh liver", "condense liver", "pack", "touch", "report"):
            with self.subTest(stage=stage):
                shutil.rmtree(self.folder / "case.parts", ignore_errors=True)
                (self.folder / "case.vtkhdf").unlink(missing_ok=True)
                (self.folder / "case.html").unlink(missing_ok=True)
                process = subprocess.Popen([BIN / "palpate", "build", self.folder / "case.toml",
                                            "-o", self.folder / "case.vtkhdf"],
                                           stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
                for line in process.stderr:
                    if line.strip() == f"palpate-build: {stage}":
                        break
                time.sleep(0.05)
                process.send_signal(signal.SIGINT)
                process.stderr.read()
                process.stderr.close()
                self.assertEqual(process.wait(timeout=60), 130)
                self.assert_nothing_partial()
                self.assertFalse((self.folder / "case.html").exists())


if __name__ == "__main__":
    unittest.main()
