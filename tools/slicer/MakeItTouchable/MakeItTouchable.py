# SPDX-License-Identifier: GPL-3.0-or-later
"""Make it touchable: a segmentation of 3D Slicer becomes an organ that a hand can feel, by the program palpate."""
import os

import ctk
import qt
import slicer
from slicer.ScriptedLoadableModule import (ScriptedLoadableModule, ScriptedLoadableModuleLogic, ScriptedLoadableModuleTest,
                                           ScriptedLoadableModuleWidget)

import palpate_steps as steps

FOLDER = os.path.dirname(os.path.abspath(__file__))
PROGRAM_SETTING, FOLDER_SETTING = "Palpate/program", "Palpate/folder"
WATCH_S = 60  # how long an organ is pressed while one watches
GRACE_MS = 5000  # until a command that was told to end is killed


class MakeItTouchable(ScriptedLoadableModule):
    def __init__(self, parent):
        super().__init__(parent)
        parent.title = "Make it touchable"
        parent.categories = ["Simulation"]
        parent.dependencies = ["Segmentations"]
        parent.contributors = ["The Palpate authors"]
        parent.helpText = ("Choose the segment that gives way and a folder. Palpate drafts a case file there, builds an organ that can be "
                           "felt, and writes a report that says how far to trust it. Not for treating patients.")
        parent.acknowledgementText = ""


def export_case(segmentation, volume, files):
    """Writes a segmentation node and, where there is one, the volume node it was made from, as they lie in the world. Throws
    RuntimeError where Slicer cannot write one."""
    mends = {files.labels: "in the module Segmentations make 'Binary labelmap' the source representation", files.volume: "see Slicer's error log"}
    for node, path in ((segmentation, files.labels), (volume, files.volume)):
        try:
            # A dictionary for each: exportNode keeps the format that it finds in the one that it is given.
            if node and not slicer.util.exportNode(node, str(path), {}, world=True):
                raise ValueError("it failed")
        except ValueError as error:
            raise RuntimeError(f"Slicer cannot write {path.name}: {error}; {mends[path]}") from error


def connect_live(port):
    """Has SlicerOpenIGTLink show what palpate sends at `port` of this machine, by one connector however often it is called."""
    connector = slicer.mrmlScene.GetFirstNodeByName("Palpate") or slicer.mrmlScene.AddNewNodeByClass("vtkMRMLIGTLConnectorNode", "Palpate")
    connector.SetTypeClient("localhost", port)
    connector.Start()


def can_show_live():
    return hasattr(slicer.modules, "openigtlinkif")


class MakeItTouchableLogic(ScriptedLoadableModuleLogic):
    """Runs palpate beside Slicer, which stays alive meanwhile."""

    def __init__(self):
        super().__init__()
        self.running = []  # processes
        self.making = None  # the one of them that drafts or builds

    def start(self, program, arguments, on_line, on_end):
        """Starts `palpate ARGUMENTS` and returns its process. `on_line` gets each line that it says, `on_end` the exit code and all
        those lines."""
        process, lines, left_over = qt.QProcess(), [], [b""]
        # Without Slicer's own libraries, which palpate's must not be mixed with.
        process.setProcessEnvironment(slicer.app.startupEnvironment())

        def read(*_):
            said, left_over[0] = steps.split_lines(left_over[0], process.readAllStandardError().data())
            for line in said:
                lines.append(line)
                on_line(line)

        def end(code):
            self.running.remove(process)
            process.deleteLater()
            on_end(code, lines)

        def finished(code, status):
            read()
            end(code if status == qt.QProcess.NormalExit else 128 + code)

        def failed(error):
            if error == qt.QProcess.FailedToStart:
                lines.append(process.errorString())
                end(steps.NOT_STARTED)

        process.connect("readyReadStandardError()", read)
        process.connect("finished(int,QProcess::ExitStatus)", finished)
        process.connect("errorOccurred(QProcess::ProcessError)", failed)
        self.running.append(process)
        process.start(program, arguments)
        return process

    def make_it_touchable(self, program, files, organ, with_volume, replace, on_line, on_end):
        """Drafts a case file and builds it; `on_end` gets None, or what to say where that failed."""
        def run(step, arguments, then):
            def ended(code, lines):
                then() if code == 0 else on_end(steps.failure(step, code, lines, files))
            self.making = self.start(program, arguments, on_line, ended)

        run("init", steps.init_arguments(files, organ, replace),
            lambda: run("build", steps.build_arguments(files, with_volume, replace), lambda: on_end(None)))

    def cancel(self):
        """Ends drafting or building, which leaves no half output."""
        self.end([process for process in self.running if process is self.making])

    def end(self, processes):
        """Tells processes to end, and kills those that do not."""
        for process in processes:
            process.terminate()
            qt.QTimer.singleShot(GRACE_MS, lambda process=process: process in self.running and process.kill())


class MakeItTouchableWidget(ScriptedLoadableModuleWidget):
    def setup(self):
        super().setup()
        self.logic = MakeItTouchableLogic()
        self.busy = False
        form = qt.QFormLayout()
        self.layout.addLayout(form)

        self.organ = slicer.qMRMLSegmentSelectorWidget()
        self.organ.setMRMLScene(slicer.mrmlScene)
        self.volume = slicer.qMRMLNodeComboBox()
        self.volume.nodeTypes = ["vtkMRMLScalarVolumeNode"]
        self.volume.addEnabled, self.volume.removeEnabled, self.volume.noneEnabled = False, False, True
        self.volume.setMRMLScene(slicer.mrmlScene)
        self.folder, self.program = ctk.ctkPathLineEdit(), ctk.ctkPathLineEdit()
        self.folder.filters, self.program.filters = ctk.ctkPathLineEdit.Dirs, ctk.ctkPathLineEdit.Files
        self.folder.currentPath = slicer.util.settingsValue(FOLDER_SETTING, "")
        self.program.currentPath = slicer.util.settingsValue(PROGRAM_SETTING, "")
        self.replace = qt.QCheckBox("Replace what is there")
        for label, widget, tip in (
                ("What gives way", self.organ, "A segment; the segments inside it become its lesions, those beside it its neighbours"),
                ("Scan", self.volume, "The CT or MRI that the segmentation was made from, shown in the trainer; none will do"),
                ("Folder", self.folder, "Where the case file, the organ and its report are written"),
                ("palpate", self.program, "The program; empty where it is on the PATH"),
                ("", self.replace, "Draft and build anew where the folder holds this organ already: what you wrote into its case file is lost")):
            widget.toolTip = tip
            form.addRow(label, widget)

        self.make = self.button("Make it touchable", self.on_make, "Drafts a case file and builds it")
        self.cancel = self.button("Cancel", self.logic.cancel, "Ends what palpate is doing; finished stages are kept")
        self.status = qt.QLabel()
        self.said = qt.QPlainTextEdit()
        self.said.readOnly = True
        self.layout.addWidget(self.status)
        self.layout.addWidget(self.said)
        self.after = [self.button("Open the report", self.on_report, "In the browser"),
                      self.button("Touch it", self.on_touch, "Opens the trainer's window: 'palpate train'"),
                      self.button("Load its meshes", self.on_load, "As models of this scene")]
        self.watch = self.button("Watch it being pressed", self.on_watch, "Live in this scene; needs the extension SlicerOpenIGTLink")
        self.layout.addStretch(1)

        self.organ.connect("currentNodeChanged(vtkMRMLNode*)", self.on_segmentation)
        self.organ.connect("currentSegmentChanged(QString)", self.update)
        for path in (self.folder, self.program):
            path.connect("currentPathChanged(QString)", self.update)
        self.on_segmentation(self.organ.currentNode())

    def button(self, text, pressed, tip):
        button = qt.QPushButton(text)
        button.toolTip = tip
        button.connect("clicked()", pressed)
        self.layout.addWidget(button)
        return button

    def cleanup(self):
        self.logic.end(list(self.logic.running))

    def organ_name(self):
        """Name of the chosen segment; None where none is."""
        node = self.organ.currentNode()
        segment = node.GetSegmentation().GetSegment(self.organ.currentSegmentID()) if node else None
        return segment.GetName() if segment else None

    def files(self):
        """Files of the chosen organ in the chosen folder; None where one of them is not chosen."""
        organ, folder = self.organ_name(), self.folder.currentPath
        return steps.case_files(folder, organ) if organ and folder else None

    def found_program(self):
        """The program; None, and a message, where it is not found."""
        setting = self.program.currentPath
        found = steps.find_program(setting, FOLDER, slicer.util.startupEnvironment().get("PATH"))
        if not found:
            slicer.util.errorDisplay(steps.missing_program(setting))
        return found

    def update(self, *_):
        files = self.files()
        done = bool(files) and files.asset.exists() and not self.busy
        self.make.enabled = bool(files) and not self.busy
        self.cancel.enabled = self.busy
        for button in self.after:
            button.enabled = done
        self.watch.enabled = done and can_show_live()

    def on_segmentation(self, node):
        if node:
            self.volume.setCurrentNode(node.GetNodeReference(slicer.vtkMRMLSegmentationNode.GetReferenceImageGeometryReferenceRole()))
        self.update()

    def show(self, line):
        self.said.appendPlainText(line)
        if progress := steps.progress_of(line):
            self.status.text = progress

    def on_make(self):
        program, files = self.found_program(), self.files()
        if not program or not files:
            return
        segmentation, volume, replace = self.organ.currentNode(), self.volume.currentNode(), self.replace.checked
        there = steps.files_in_the_way(files, bool(volume))
        if there and not replace:
            slicer.util.errorDisplay(f"{there[0]} exists already; choose another folder or 'Replace what is there'")
        else:
            self.run(program, files, segmentation, volume, replace)

    def run(self, program, files, segmentation, volume, replace):
        self.said.clear()
        self.busy = True
        self.status.text = "writing"
        self.update()
        slicer.app.settings().setValue(FOLDER_SETTING, self.folder.currentPath)
        slicer.app.settings().setValue(PROGRAM_SETTING, self.program.currentPath)
        try:
            export_case(segmentation, volume, files)
        except RuntimeError as error:
            self.on_made(str(error))
            return
        self.logic.make_it_touchable(program, files, self.organ_name(), bool(volume), replace, self.show, self.on_made)

    def on_made(self, failure):
        self.busy = False
        self.status.text = "failed" if failure else "done"
        self.update()
        if failure:
            slicer.util.errorDisplay(failure)

    def on_report(self):
        qt.QDesktopServices.openUrl(qt.QUrl.fromLocalFile(str(self.files().report)))

    def on_load(self):
        for path in steps.mesh_files(self.files()):
            slicer.util.loadModel(str(path))

    def start(self, arguments):
        """Starts a command that works on the finished organ; False where there is no program."""
        program, files = self.found_program(), self.files()

        def ended(code, lines):
            if code:
                slicer.util.errorDisplay(steps.failure(arguments[0], code, lines, files))
        if program:
            self.logic.start(program, arguments, self.said.appendPlainText, ended)
        return bool(program)

    def on_touch(self):
        self.start(steps.train_arguments(self.files().asset))

    def on_watch(self):
        if self.start(steps.touch_arguments(self.files().asset, steps.PORT, WATCH_S)):
            connect_live(steps.PORT)


class MakeItTouchableTest(ScriptedLoadableModuleTest):
    """Runs in Slicer: Developer mode, Reload and Test."""

    def runTest(self):
        slicer.mrmlScene.Clear()
        self.test_a_segmentation_is_written_as_palpate_reads_it()

    def test_a_segmentation_is_written_as_palpate_reads_it(self):
        import tempfile
        import numpy
        voxels = numpy.zeros((20, 20, 20), dtype=numpy.uint8)
        voxels[5:15, 5:15, 5:15] = 1
        labels = slicer.util.addVolumeFromArray(voxels, nodeClassName="vtkMRMLLabelMapVolumeNode")
        segmentation = slicer.mrmlScene.AddNewNodeByClass("vtkMRMLSegmentationNode")
        slicer.modules.segmentations.logic().ImportLabelmapToSegmentationNode(labels, segmentation)
        organ = segmentation.GetSegmentation().GetNthSegment(0).GetName()
        with tempfile.TemporaryDirectory() as folder:
            files = steps.case_files(folder, organ)
            export_case(segmentation, slicer.util.addVolumeFromArray(voxels.astype(numpy.int16)), files)
            self.assertEqual(steps.files_in_the_way(files, with_volume=True), [files.labels, files.volume])
            self.assertIn(f"Name:={organ}".encode(), files.labels.read_bytes())
