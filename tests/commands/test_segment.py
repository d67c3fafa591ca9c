# SPDX-License-Identifier: GPL-3.0-or-later
"""palpate import and palpate segment: exit codes, messages, and outputs whole or not at all."""
import json
import os
import pathlib
import resource
import signal
import subprocess
import tempfile
import unittest

BIN = pathlib.Path(os.environ["PALPATE_BIN"])
PHANTOM = pathlib.Path(os.environ["PALPATE_BUILD"]) / "tests" / "phantom"

OK, FAILED, USAGE, INVALID = 0, 1, 2, 3


def run(program, *arguments, **options):
    return subprocess.run([program, *map(str, arguments)], text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          timeout=120, **options)


class ImagingCommand(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.inputs = tempfile.TemporaryDirectory()
        cls.volume = pathlib.Path(cls.inputs.name) / "head.nrrd"
        cls.truth = pathlib.Path(cls.inputs.name) / "head.seg.nrrd"
        made = run(PHANTOM, "head", cls.volume, cls.truth)
        assert made.returncode == OK, made.stderr

    @classmethod
    def tearDownClass(cls):
        cls.inputs.cleanup()

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.output = pathlib.Path(self.folder.name) / "out.seg.nrrd"

    def import_(self, *arguments, **options):
        return run(BIN / "palpate-import", *arguments, **options)

    def segment(self, *arguments, output=None, **options):
        return run(BIN / "palpate-segment", *arguments, "-o", output or self.output, **options)

    def expect(self, result, code, *phrases):
        self.assertEqual(result.returncode, code, result.stderr)
        for phrase in phrases:
            self.assertIn(phrase, result.stderr)
        if code != OK:
            self.assertEqual(os.listdir(self.folder.name), [], "an output was left behind")


class Segment(ImagingCommand):
    RECIPES = ["--structure", "skull: recipe=bone", "--structure",
               "airway: recipe=airway seeds_mm=0,-5,-40 opening_mm=4"]

    def test_result_describes_each_label(self):
        result = self.segment("--volume", self.volume, *self.RECIPES, "--json", "-")
        self.expect(result, OK)
        answer = json.loads(result.stdout)
        self.assertEqual(answer["schema"], "palpate.segment/1")
        skull, airway = answer["labels"]
        self.assertEqual([skull["name"], skull["value"], airway["name"], airway["value"]],
                         ["skull", 1, "airway", 2])
        self.assertAlmostEqual(skull["volume_ml"], skull["voxels"] * 8 / 1000)
        self.assertEqual(airway["components"], 1)
        for axis in range(3):
            self.assertLess(airway["box_min_mm"][axis], airway["centroid_mm"][axis])
            self.assertLess(airway["centroid_mm"][axis], airway["box_max_mm"][axis])
        self.assertTrue(self.output.is_file())

    def test_same_recipes_give_the_same_bytes_at_any_thread_count(self):
        contents = set()
        for threads in (1, 2, 3):
            self.expect(self.segment("--volume", self.volume, *self.RECIPES, "--threads", threads, "--force"), OK)
            contents.add(self.output.read_bytes())
        self.assertEqual(len(contents), 1)

    def test_recipes_with_seeds_give_the_same_bytes_at_any_thread_count(self):
        abdomen = pathlib.Path(self.inputs.name) / "abdomen.nrrd"
        made = run(PHANTOM, "abdomen", abdomen, pathlib.Path(self.inputs.name) / "abdomen.seg.nrrd")
        self.assertEqual(made.returncode, OK, made.stderr)
        contents = set()
        for threads in (1, 2, 8):
            self.expect(self.segment("--volume", abdomen, "--structure",
                                     "liver: recipe=liver seeds=-14,-6,16;-30,-6,-4 neck_mm=4 gap_mm=10",
                                     "--structure", "tumour: recipe=tumour inside=liver seeds=-22,-10,4",
                                     "--structure", "vessels: recipe=vessels inside=liver max_radius_mm=6",
                                     "--structure", "muscle: recipe=grow-from-seeds seeds=34,20,0",
                                     "--threads", threads, "--force"), OK)
            contents.add(self.output.read_bytes())
        self.assertEqual(len(contents), 1)

    def test_seeds_come_from_slicers_files(self):
        points = pathlib.Path(self.inputs.name) / "points.fcsv"
        points.write_text("# CoordinateSystem = RAS\n1,0,5,-40,0,0,0,1,1,1,0,airway-1,,\n"
                          "2,60,60,60,0,0,0,1,1,1,0,elsewhere,,\n")
        structure = f"airway: recipe=airway opening_mm=4 seeds_file={points}"
        self.expect(self.segment("--volume", self.volume, "--structure", structure), OK)
        from_file = self.output.read_bytes()
        self.expect(self.segment("--volume", self.volume, *self.RECIPES[2:], "--force"), OK)
        self.assertEqual(from_file, self.output.read_bytes())
        self.output.unlink()
        self.expect(self.segment("--volume", self.volume, "--structure", structure.replace("airway:", "nose:")),
                    INVALID, "structure 'nose': no seed is labelled 'nose' (expected one of the labels 'airway', "
                             "'elsewhere'")
        self.expect(self.segment("--volume", self.volume, "--structure", structure + "x"), INVALID, "points.fcsvx")

    def test_what_was_assumed_is_said_and_reported(self):
        result = self.segment("--volume", self.volume, "--structure", "skull: recipe=bone threshold_hu=0",
                              "--json", "-")
        self.expect(result, OK, "structure 'skull': threshold")
        self.assertIn("HU found", json.loads(result.stdout)["notes"][0])

    def test_recipe_file_equals_options(self):
        recipes = pathlib.Path(self.inputs.name) / "recipes.json"
        recipes.write_text(json.dumps([
            {"name": "skull", "recipe": "bone"},
            {"name": "airway", "recipe": "airway", "parameters": {"seeds_mm": [[0, -5, -40]], "opening_mm": 4}}]))
        self.expect(self.segment("--volume", self.volume, "--recipes", recipes), OK)
        from_file = self.output.read_bytes()
        self.expect(self.segment("--volume", self.volume, *self.RECIPES, "--force"), OK)
        self.assertEqual(from_file, self.output.read_bytes())

    def test_bad_recipe_files_are_refused(self):
        recipes = pathlib.Path(self.inputs.name) / "bad.json"
        for text, phrase in (("{", "not a JSON array"), ("[" * 100000 + "]" * 100000, "nested more than 32 deep"),
                             ('[{"name": "a"}]', "no recipe"), ("[1]", "holds 1"),
                             ('[{"name": "a", "recipe": "bone", "color": 1}]', "unknown key 'color'"),
                             ('[{"name": "a", "recipe": "bone", "parameters": {"open_mm": null}}]', "open_mm")):
            recipes.write_text(text)
            self.expect(self.segment("--volume", self.volume, "--recipes", recipes), INVALID, phrase)

    def test_missing_label_names_the_nearest(self):
        self.expect(self.segment("--labels", self.truth, "--structure", "a: recipe=import label=skul"),
                    INVALID, "palpate-segment: structure 'a': no label 'skul'; nearest names: 'skull'")

    def test_empty_structure_says_what_to_change(self):
        self.expect(self.segment("--volume", self.volume, "--structure", "skull: recipe=bone threshold_hu=3000"),
                    INVALID, "structure 'skull': is empty; lower threshold_hu")

    def test_unknown_parameter_suggests_one(self):
        self.expect(self.segment("--volume", self.volume, "--structure", "skull: recipe=bone treshold_hu=300"),
                    INVALID, "no parameter 'treshold_hu'; nearest names: 'threshold_hu'")

    def test_misuse_is_a_usage_error(self):
        self.expect(self.segment("--volume", self.volume), USAGE, "--structure: none given")
        self.expect(self.segment("--structure", "skull: recipe=bone"), USAGE, "--volume: not given")
        self.expect(self.segment("--volume", self.volume, "--structure", "skull recipe=bone"), USAGE,
                    "no name before a colon")
        self.expect(self.segment("--volume", self.volume, "--structure", "a\udcff: recipe=bone", "--json", "-"), USAGE,
                    "no UTF-8 text")
        self.expect(self.segment("--volume", self.volume, *self.RECIPES, "--strcture", "x"), USAGE, "--structure")

    def test_existing_output_needs_force(self):
        self.output.write_text("precious")
        result = self.segment("--volume", self.volume, *self.RECIPES)
        self.assertEqual(result.returncode, INVALID)
        self.assertIn("exists already", result.stderr)
        self.assertEqual(self.output.read_text(), "precious")

    def test_full_disk_leaves_nothing_behind(self):
        def no_room():
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (500, 500))
        self.expect(self.segment("--volume", self.volume, *self.RECIPES, "--quiet", preexec_fn=no_room), FAILED,
                    "could not be written", "check free space")

    def test_interrupt_leaves_nothing_behind(self):
        with subprocess.Popen([BIN / "palpate-segment", "--volume", self.volume, *self.RECIPES, "-o", self.output],
                              stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True) as process:
            self.assertIn("reading", process.stderr.readline())
            process.send_signal(signal.SIGINT)
            process.stderr.read()
            self.assertEqual(process.wait(60), 130)
        self.assertEqual(os.listdir(self.folder.name), [])

    def test_help_lists_every_recipe_with_units_and_defaults(self):
        text = self.segment("--help").stdout
        for phrase in ("airway", "bone", "import", "nasopharynx", "sphere", "threshold_hu", "[HU] (default 226)", "liver",
                       "tumour", "vessels", "brain", "grow-from-seeds", "seeds_file", "scribbles", "smooth_mm",
                       "apply in the order written", "thinned evenly", "with a blank", "thickness_mm", "[mm] (default 6)"):
            self.assertIn(phrase, text)


class Import(ImagingCommand):
    def setUp(self):
        super().setUp()
        self.nrrd = pathlib.Path(self.folder.name) / "out.nrrd"

    def test_imported_volume_keeps_its_values(self):
        self.expect(self.import_(self.volume, "-o", self.nrrd), OK)
        self.assertEqual(self.nrrd.read_bytes(), self.volume.read_bytes())

    def test_labels_are_renamed_and_the_rest_dropped(self):
        result = self.import_("--labels", self.truth, "--label-names", "3=soft wall", "-o", self.output, "--json", "-")
        self.expect(result, OK)
        labels = json.loads(result.stdout)["labels"]
        self.assertEqual([(label["name"], label["value"]) for label in labels], [("soft wall", 3)])
        self.assertIn(b"Segment0_Name:=soft wall", self.output.read_bytes())
        self.assertNotIn(b"skull", self.output.read_bytes()[:2000])

    def test_bad_inputs_are_refused(self):
        absent = pathlib.Path(self.inputs.name) / "absent.nrrd"
        cut = pathlib.Path(self.inputs.name) / "cut.nrrd"
        cut.write_bytes(self.volume.read_bytes()[:-2000])
        text = pathlib.Path(self.inputs.name) / "notes.txt"
        text.write_text("not an image")
        empty_folder = pathlib.Path(self.inputs.name) / "empty"
        empty_folder.mkdir(exist_ok=True)
        for path, phrase in ((absent, "no such file"), (cut, "cannot be read"), (text, "is not a volume"),
                             (empty_folder, "holds no DICOM")):
            self.expect(self.import_(path, "-o", self.nrrd), INVALID, f"palpate-import: {path}", phrase)

    def test_misuse_is_told(self):
        self.expect(self.import_(self.volume, "-o", self.nrrd, "--label-names", "1=a"), USAGE, "--label-names")
        self.expect(self.import_("--labels", self.truth, "--label-names", "skull", "-o", self.output), USAGE, "'skull'")
        self.expect(self.import_("--labels", self.truth, "--label-names", "9=a", "-o", self.output), INVALID,
                    "no label '9'")
        self.expect(self.import_(self.volume, "-o", self.output.with_suffix(".mha")), INVALID, "expected .nrrd")


if __name__ == "__main__":
    unittest.main()
