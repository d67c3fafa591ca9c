# SPDX-License-Identifier: GPL-3.0-or-later
"""Stands in for 3D Slicer, its Qt and its nodes, as far as 'Make it touchable' asks for them. Its processes are real ones."""
import os
import shutil
import subprocess
import sys
import types
from unittest import mock


class Process:
    """A QProcess that runs to its end in start(), or, where `held`, waits for terminate() or kill()."""
    NormalExit, CrashExit = 0, 1
    FailedToStart = 0
    held = False
    started = []  # command lines

    def __init__(self):
        self.slots, self.said = {}, b""

    def setProcessEnvironment(self, environment):
        self.environment = environment

    def connect(self, signal, slot):
        self.slots[signal.partition("(")[0]] = slot

    def start(self, program, arguments):
        Process.started.append(arguments)
        if self.held:
            return
        try:
            ran = subprocess.run([program, *arguments], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, env=self.environment)
        except OSError:
            self.slots["errorOccurred"](self.FailedToStart)
            return
        middle = len(ran.stderr) // 2
        for self.said in (ran.stderr[:middle], ran.stderr[middle:]):
            self.slots["readyReadStandardError"]()
        self.finish(ran.returncode)

    def finish(self, code):
        self.slots["finished"](code, self.NormalExit)

    def terminate(self):
        self.finish(130)

    def readAllStandardError(self):
        said, self.said = self.said, b""
        return types.SimpleNamespace(data=lambda: said)

    def errorString(self):
        return "execve: no such file"

    def deleteLater(self):
        pass


def widget(*_):
    """Takes every call and every property."""
    return mock.Mock()


widget.Dirs, widget.Files = 1, 2


class Widgets:
    """A module of which every class is widget()."""

    def __getattr__(self, name):
        return widget


class Segmentation:
    """A segmentation node whose file is there already, with one volume that it was made from."""

    def __init__(self, source, volume):
        self.source, self.volume = source, volume

    def GetSegmentation(self):
        return types.SimpleNamespace(GetSegment=lambda name: types.SimpleNamespace(GetName=lambda: name))

    def GetNodeReference(self, role):
        return self.volume


class Slicer:
    """Modules by the names under which the extension imports them, and what it did with them."""

    def __init__(self):
        self.shown, self.models, self.opened, self.settings = [], [], [], {}  # messages, loaded models, opened addresses
        self.connector = mock.Mock()
        util = types.SimpleNamespace(
            exportNode=self.export, errorDisplay=self.shown.append, loadModel=self.models.append,
            settingsValue=self.settings.get, startupEnvironment=lambda: dict(os.environ))
        scene = types.SimpleNamespace(GetFirstNodeByName=lambda name: None, AddNewNodeByClass=lambda kind, name: self.connector)
        app = types.SimpleNamespace(startupEnvironment=lambda: dict(os.environ),
                                    settings=lambda: types.SimpleNamespace(setValue=self.settings.__setitem__))
        self.slicer = types.ModuleType("slicer")
        self.slicer.__dict__.update(util=util, mrmlScene=scene, app=app, modules=types.SimpleNamespace(), vtkMRMLSegmentationNode=mock.Mock(),
                                    qMRMLSegmentSelectorWidget=widget, qMRMLNodeComboBox=widget)
        qt, ctk, scripted = Widgets(), Widgets(), types.ModuleType("slicer.ScriptedLoadableModule")
        qt.QProcess, qt.QTimer = Process, types.SimpleNamespace(singleShot=lambda wait_ms, call: call())
        qt.QUrl = types.SimpleNamespace(fromLocalFile=lambda path: path)
        qt.QDesktopServices = types.SimpleNamespace(openUrl=self.opened.append)
        for name in ("", "Widget", "Logic", "Test"):
            base = f"ScriptedLoadableModule{name}"
            setattr(scripted, base, type(base, (), {"__init__": lambda self, *_: None, "setup": lambda self: None, "layout": mock.Mock()}))
        self.modules = {"slicer": self.slicer, "slicer.ScriptedLoadableModule": scripted, "qt": qt, "ctk": ctk}

    def export(self, node, path, properties, world):
        """As slicer.util.exportNode, which keeps the format that it finds in `properties` and so wants new ones each time."""
        assert world and not properties
        properties["fileFormat"] = path
        if not node.source:
            raise ValueError("no known file format was found")
        shutil.copy(node.source, path)
        return True

    def __enter__(self):
        Process.started, Process.held = [], False
        self.before = {name: sys.modules.get(name) for name in self.modules}
        sys.modules.update(self.modules)
        return self

    def __exit__(self, *_):
        for name, module in self.before.items():
            sys.modules.pop(name)
            if module:
                sys.modules[name] = module
