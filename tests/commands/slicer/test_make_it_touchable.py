# SPDX-License-Identifier: GPL-3.0-or-later
"""The extension 'Make it touchable' of 3D Slicer: its steps with the real programs, its flow with a stand-in for Slicer."""
import importlib
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import types
import unittest

from slicer_stand_in import Process, Segmentation, Slicer

BIN = pathlib.Path(os.environ["PALPATE_BIN"])
PHANTOM = pathlib.Path(os.environ["PALPATE_BUILD"]) / "tests" / "phantom"
MODULE = pathlib.Path(os.environ["PALPATE_SOURCE"]) / "tools" / "slicer" / "MakeItTouchable"
sys.path.insert(0, str(MODULE))
sys.dont_write_bytecode = True
import palpate_steps as steps  # noqa: E402


def run(*arguments):
    return subprocess.run(list(map(str, arguments)), text=True, capture_output=True, timeout=200)


class Phantom(unittest.TestCase):
    """Gives its tests `scan` and `labels`, and `folder`, one of their own."""

    @classmethod
    def setUpClass(cls):
        scratch = tempfile.TemporaryDirectory()
        cls.addClassCleanup(scratch.cleanup)
        cls.scan, cls.labels = pathlib.Path(scratch.name) / "abdomen.nrrd", pathlib.Path(scratch.name) / "truth.seg.nrrd"
        made = run(PHANTOM, "abdomen", cls.scan, cls.labels)
        assert made.returncode == 0, made.stderr

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def renamed(self, old, new):
        """A copy of the label map in which the segment `old` is called `new`."""
        path = self.folder / "renamed.seg.nrrd"
        path.write_bytes(self.labels.read_bytes().replace(f"_Name:={old}\n".encode(), f"_Name:={new}\n".encode()))
        return path


class Steps(Phantom):
    def palpate(self, arguments):
        return run(BIN / "palpate", *arguments)

    def test_options_of_what_no_test_runs_to_its_end_are_those_of_the_programs(self):
        files = steps.case_files(self.folder, "liver")
        for arguments in (steps.init_arguments(files, "liver", True), steps.build_arguments(files, True, True),
                          steps.touch_arguments(files.asset, steps.PORT, 3)):
            said = self.palpate([arguments[0], "--help"]).stdout
            for word in arguments[1:]:
                if word.startswith("-"):
                    self.assertRegex(said, rf"(?<![\w-]){re.escape(word.partition('=')[0])}\b")

    def test_a_segment_whose_name_is_no_file_name_can_be_drafted(self):
        name = "- Leber (links), größer"
        files = steps.case_files(self.folder, name)
        self.assertEqual(files.asset.name, "Leber_links_groer.vtkhdf")
        self.renamed("liver", name).rename(files.labels)
        made = self.palpate(steps.init_arguments(files, name, replace=False))
        self.assertEqual(made.returncode, 0, made.stderr)
        self.assertIn(name, files.case.read_text())

    def test_names_of_files_are_never_empty_hidden_or_folders(self):
        for name, stem in (("Segment_1", "Segment_1"), ("../../etc", "etc"), (".hidden", "hidden"), ("肝臓", "organ"), ("", "organ"),
                           ("a\\b", "a_b")):
            self.assertEqual(steps.file_stem(name), stem)

    def test_exit_codes_are_those_of_the_help(self):
        said = " ".join(self.palpate(["build", "--help"]).stdout.split())
        for code, meaning in steps.EXIT_CODES.items():
            if code != steps.NOT_STARTED:
                self.assertIn(f"{code} {meaning}", said)
        self.assertIn("crashed", steps.exit_meaning(139))

    def test_what_a_failed_command_said_is_told_as_it_is(self):
        files = steps.case_files(self.folder, "liver")
        files.labels.symlink_to(self.labels)
        made = self.palpate(steps.init_arguments(files, "lever", replace=False))
        said = steps.failure("init", made.returncode, made.stderr.splitlines(), files)
        self.assertIn("palpate init, exit code 3: invalid input", said)
        self.assertIn("no label 'lever'; nearest names: 'liver'", said)
        files.parts.mkdir()
        page = files.parts / "failure.html"
        self.assertNotIn(str(page), steps.failure("build", 4, [], files))
        page.touch()
        self.assertIn(str(page), steps.failure("build", 4, [], files))

    def test_lines_are_whole_wherever_they_are_cut(self):
        text = "palpate-build: mesh größer\r\npalpate-mesh: refine\nrest".encode()
        for cut in range(len(text) + 1):
            first, left_over = steps.split_lines(b"", text[:cut])
            second, left_over = steps.split_lines(left_over, text[cut:])
            self.assertEqual([line for line in first + second if line], ["palpate-build: mesh größer", "palpate-mesh: refine"])
            self.assertEqual(left_over, b"rest")
        self.assertEqual(list(map(steps.progress_of, first + second + ["made.nrrd: 3 labels"])), ["mesh größer", "mesh: refine", None])

    def test_the_program_is_found_where_it_is_said_to_be_on_the_path_or_beside_the_module(self):
        installed = self.folder / "share/palpate/slicer/MakeItTouchable"
        for setting, folder, path, found in (
                (BIN, MODULE, "", BIN), (BIN / "palpate", MODULE, "", BIN), ("", MODULE, str(BIN), BIN),
                (self.folder, MODULE, str(BIN), None), (self.labels, MODULE, str(BIN), None), ("", installed, str(self.folder), None)):
            wanted = str(found / "palpate") if found else None
            self.assertEqual(steps.find_program(str(setting), folder, path), wanted)
        (self.folder / "bin").symlink_to(BIN)
        self.assertIsNotNone(steps.find_program("", installed, str(self.folder)))
        self.assertIn("palpate-tools", steps.missing_program(""))


class Flow(Phantom):
    """The module in a stand-in for Slicer, which its own test class replaces where there is Slicer."""

    def setUp(self):
        super().setUp()
        self.slicer = Slicer().__enter__()
        self.addCleanup(self.slicer.__exit__)
        sys.modules.pop("MakeItTouchable", None)
        self.module = importlib.import_module("MakeItTouchable")
        self.addCleanup(sys.modules.pop, "MakeItTouchable")

    def widget(self, organ, labels=None, program=BIN):
        """The module's panel after its user chose everything."""
        widget = self.module.MakeItTouchableWidget()
        volume = types.SimpleNamespace(source=self.scan)
        node = Segmentation(labels or self.labels, volume)
        chosen = {"currentNode.return_value": node, "currentSegmentID.return_value": organ}
        widget.setup()
        widget.organ.configure_mock(**chosen)
        widget.volume.configure_mock(**{"currentNode.return_value": volume})
        widget.folder.currentPath, widget.program.currentPath = str(self.folder), str(program)
        widget.replace.checked = False
        widget.update()
        return widget

    def test_a_segmentation_becomes_an_asset_that_verifies_and_can_be_looked_at_and_touched(self):
        widget = self.widget("liver")
        self.assertFalse(widget.after[0].enabled)
        widget.on_make()
        self.assertEqual(self.slicer.shown, [])
        self.assertEqual((widget.status.text, widget.busy), ("done", False))
        said = [call.args[0] for call in widget.said.appendPlainText.call_args_list]
        self.assertIn("palpate-build: condense liver", said)
        files = steps.case_files(self.folder, "liver")
        verified = run(BIN / "palpate", "verify", files.asset, "--json", "-")
        self.assertEqual(verified.returncode, 0, verified.stderr)
        self.assertIn("scan", json.loads(run(BIN / "palpate", "inspect", files.asset, "--json", "-").stdout))

        self.assertTrue(widget.after[0].enabled)
        self.assertFalse(widget.watch.enabled, "without SlicerOpenIGTLink")
        widget.on_report()
        self.assertEqual(self.slicer.opened, [str(files.report)])
        widget.on_load()
        self.assertIn(str(files.parts / "liver.vtu"), self.slicer.models)
        self.assertEqual({pathlib.Path(path).suffix for path in self.slicer.models}, {".vtu", ".vtp"})
        Process.held = True
        widget.on_touch()
        self.assertEqual(Process.started[-1], ["train", str(files.asset)])
        self.slicer.slicer.modules.openigtlinkif = object()
        widget.update()
        self.assertTrue(widget.watch.enabled)
        widget.on_watch()
        self.assertEqual(Process.started[-1][0], "touch")
        self.slicer.connector.SetTypeClient.assert_called_with("localhost", steps.PORT)

        widget.on_make()
        self.assertIn("exists already", self.slicer.shown.pop())
        widget.replace.checked = True
        widget.on_make()
        self.assertEqual(Process.started[-1][0], "init")
        self.assertIn("--force", Process.started[-1])

    def test_what_palpate_says_of_a_failure_is_shown_as_it_is(self):
        widget = self.widget("lever")
        widget.on_make()
        message, = self.slicer.shown
        self.assertIn("exit code 3: invalid input", message)
        self.assertIn("nearest names: 'liver'", message)
        self.assertEqual((widget.status.text, widget.busy, widget.make.enabled), ("failed", False, True))

    def test_a_program_that_is_not_there_or_does_not_start_is_told(self):
        widget = self.widget("liver", program=self.folder)
        widget.on_make()
        self.assertIn("Install the packages", self.slicer.shown.pop())
        false_program = self.folder / "palpate"
        false_program.write_text("#!/nowhere\n")
        false_program.chmod(0o755)
        self.widget("liver", program=false_program).on_make()
        self.assertIn("could not be started", self.slicer.shown.pop())

    def test_a_name_that_no_asset_takes_is_refused_before_anything_is_built(self):
        self.widget("liver", self.renamed("ribs", "left/right")).on_make()
        message, = self.slicer.shown
        self.assertIn("palpate init, exit code 3: invalid input", message)
        self.assertIn("'left/right'", message)
        self.assertEqual([arguments[0] for arguments in Process.started], ["init"])

    def test_a_segmentation_that_slicer_does_not_write_is_told_with_the_way_out(self):
        widget = self.widget("liver")
        widget.organ.currentNode().source = None
        widget.on_make()
        self.assertIn("Binary labelmap", self.slicer.shown.pop())
        self.assertEqual(Process.started, [])

    def test_cancelling_ends_what_is_made_and_nothing_else(self):
        Process.held = True
        widget = self.widget("liver")
        files = widget.files()
        files.asset.touch()
        widget.on_touch()
        files.asset.unlink()
        widget.on_make()
        self.assertTrue(widget.cancel.enabled)
        widget.logic.cancel()
        self.assertEqual((len(widget.logic.running), widget.busy), (1, False))
        self.assertIn("130: interrupted", self.slicer.shown.pop())
        self.assertEqual([arguments[0] for arguments in Process.started], ["train", "init"])
        widget.cleanup()
        self.assertEqual(widget.logic.running, [])


if __name__ == "__main__":
    unittest.main()
