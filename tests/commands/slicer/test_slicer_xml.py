# SPDX-License-Identifier: GPL-3.0-or-later
"""What every command says of itself with --xml loads as a module of 3D Slicer, and what Slicer then calls is understood.

The rules are those of Slicer's ModuleDescriptionParser, which refuses the whole module where one is broken, and, for which elements
there are and in which order, those of CTK's schema of command line modules, which is stricter.
"""
import json
import os
import pathlib
import re
import subprocess
import tempfile
import unittest
import xml.etree.ElementTree as ElementTree

BIN = pathlib.Path(os.environ["PALPATE_BIN"])
PHANTOM = pathlib.Path(os.environ["PALPATE_BUILD"]) / "tests" / "phantom"
IDENTIFIER = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
ABOUT = ["category", "title", "description", "version", "license", "contributor"]  # of an executable, in order
OF_PARAMETER = ["name", "longflag", "index", "description", "label", "default", "channel"]  # in order
NUMBERS = {"integer": int, "double": float}
ATTRIBUTES = {"file": {"multiple", "fileExtensions"}, "string": {"multiple"}, "integer": {"multiple"}, "double": {"multiple"},
              "boolean": set()}

# What a command needs though no single one of it is required: a value, or "" for the input file.
BEYOND_REQUIRED = {"palpate-doctor": {"seconds": "0.1"}, "palpate-import": {"output": "made.nrrd"}, "palpate-report": {"asset": ""},
                   "palpate-mesh": {"labels": "", "region": "none"}, "palpate-surface": {"labels": "", "label": "liver"},
                   "palpate-segment": {"labels": "", "structure": "liver: recipe=import"}}
OUTPUTS = {"palpate-build": "made.vtkhdf", "palpate-init": "made.toml", "palpate-surface": "made.vtp", "palpate-segment": "made.seg.nrrd"}
WINDOWLESS = {name: value for name, value in os.environ.items() if name not in ("DISPLAY", "WAYLAND_DISPLAY")}


def commands():
    return sorted(path for path in BIN.glob("palpate-*") if "." not in path.name)


def run(*arguments, **how):
    return subprocess.run(list(map(str, arguments)), text=True, capture_output=True, timeout=60, **how)


def misplaced(elements, order):
    """Names of elements that are unknown, doubled or not in that order."""
    names = [element.tag for element in elements]
    return [] if names == [name for name in order if name in names] else names


def errors_of_parameter(parameter):
    value = {child.tag: (child.text or "").strip() for child in parameter}
    if parameter.tag not in ATTRIBUTES:
        return [f"<{parameter.tag}> is no parameter"]
    errors = [f"{name} is no attribute of <{parameter.tag}>" for name in parameter.attrib if name not in ATTRIBUTES[parameter.tag]]
    errors += [f"elements {names}" for names in [misplaced(parameter, OF_PARAMETER)] if names]
    errors += [f"no <{name}>" for name in ("name", "description", "label") if not value.get(name)]
    errors += [f"{value[name]} is no identifier" for name in ("name", "longflag")
               if name in value and not IDENTIFIER.fullmatch(value[name].lstrip("-"))]
    if ("longflag" in value) == ("index" in value):
        errors.append("neither a flag nor a place, or both")
    if value.get("channel", "input") not in ("input", "output"):
        errors.append(f"channel {value['channel']}")
    if parameter.tag in NUMBERS:  # Slicer passes its default, filled in or not
        try:
            NUMBERS[parameter.tag](value.get("default", ""))
        except ValueError:
            errors.append(f"default '{value.get('default', '')}' is no number")
    return [f"{value.get('name')}: {error}" for error in errors]


def errors_of_module(text):
    """Why Slicer, or whoever goes by CTK's schema, does not take a description."""
    module = ElementTree.fromstring(text)
    if module.tag != "executable":
        return [f"<{module.tag}> outermost"]
    *about, group = module
    errors = [f"executable: elements {names}" for names in [misplaced(about, ABOUT)] if names]
    if [element.tag for element in (group, *group[:2])] != ["parameters", "label", "description"] or len(group) < 3:
        return [*errors, "no parameters with label and description"]
    parameters = group[2:]
    errors += [error for parameter in parameters for error in errors_of_parameter(parameter)]
    for what in ("name", "longflag", "index"):
        values = [value for parameter in parameters if (value := parameter.findtext(what)) is not None]
        if len(set(values)) < len(values):
            errors.append(f"a {what} twice in {values}")
        if what == "index" and values != list(map(str, range(len(values)))):
            errors.append(f"places {values}")
    return errors


def slicer_arguments(text, filled_in):
    """What Slicer's vtkSlicerCLIModuleLogic passes where its user filled in some parameters, by name: flags first, then places; of
    numbers their defaults, of files and texts what is not empty."""
    flags, places = [], []
    for parameter in ElementTree.fromstring(text).find("parameters")[2:]:
        value = filled_in.get(parameter.findtext("name"), parameter.findtext("default") or "")
        if parameter.find("index") is not None:
            places += [value] if value else []
        elif parameter.tag == "boolean":
            flags += ["--" + parameter.findtext("longflag").lstrip("-")] if value == "true" else []
        elif value or parameter.tag in NUMBERS:
            flags += ["--" + parameter.findtext("longflag").lstrip("-"), value]
    return flags + places


def outcome(command, given, unasked):
    """How a command ends in an empty folder where its user filled in no more than it takes, its input files by `given`, with what
    Slicer passes unasked or without: exit code and errors."""
    filled_in = {name: value or str(given) for name, value in BEYOND_REQUIRED.get(command.name, {}).items()}
    module = ElementTree.fromstring(run(command, "--xml").stdout)
    for parameter in [] if unasked else module.find("parameters")[2:]:
        for default in parameter.findall("default"):
            parameter.remove(default)
            parameter.tag = "string"  # of numbers, too, Slicer passes what is filled in only
    text = ElementTree.tostring(module, encoding="unicode")
    channels = {parameter.findtext("name"): parameter.findtext("channel") for parameter in module.find("parameters")[2:]}
    while True:
        with tempfile.TemporaryDirectory() as place:
            ended = run(command, *slicer_arguments(text, filled_in), "--quiet", cwd=place, env=WINDOWLESS)
        lacking = re.search(r"(\S+) is required", ended.stderr)
        name = lacking and lacking[1].lstrip("-").replace("-", "_")
        if not lacking or name in filled_in:
            return ended.returncode, ended.stderr
        filled_in[name] = str(given) if channels[name] == "input" else OUTPUTS.get(command.name, "none")


class Descriptions(unittest.TestCase):
    def test_every_command_loads_as_a_module(self):
        self.assertGreater(len(commands()), 15)
        for command in commands():
            with self.subTest(command.name):
                told = run(command, "--xml")
                self.assertEqual((told.returncode, told.stderr), (0, ""))
                self.assertEqual(errors_of_module(told.stdout), [])

    def test_what_slicer_passes_unasked_changes_nothing(self):
        with tempfile.TemporaryDirectory() as scratch:
            folder, file, labels, scan = (pathlib.Path(scratch) / name for name in ("folder", "file.tsv", "labels.seg.nrrd", "scan.nrrd"))
            folder.mkdir()
            file.touch()
            self.assertEqual(run(PHANTOM, "abdomen", scan, labels).returncode, 0)
            for command in commands():
                for given in (folder, file, labels) if "<channel>input" in run(command, "--xml").stdout else (folder,):
                    with self.subTest(command.name, given=given.name):
                        self.assertEqual(*(outcome(command, given, unasked) for unasked in (True, False)))

    def test_a_value_that_begins_like_an_option_is_left_as_it_is(self):
        corners = ("0 0 0", "0 9 0", "9 0 0", "0 0 9")
        facets = [[corners[i] for i in triangle] for triangle in ((0, 1, 2), (0, 2, 3), (0, 3, 1), (1, 3, 2))]
        for words, title in ((["--title", "--my_title"], "--my_title"), (["--title=--my_title"], "--my_title"), (["--title", "--"], "--"),
                             (["--title", "--algorithm_name", "--algorithm_name", "a_b"], "--algorithm_name")):
            with self.subTest(words), tempfile.TemporaryDirectory() as scratch:
                surface = pathlib.Path(scratch) / "surface.stl"
                surface.write_text("solid a\n" + "".join(
                    "facet normal 0 0 0\nouter loop\n" + "".join(f"vertex {corner}\n" for corner in facet) + "endloop\nendfacet\n"
                    for facet in facets) + "endsolid a\n")
                made = run(BIN / "palpate-export", *words, surface, "-o", surface.with_suffix(".dcm"), "--unit", "mm", "--frame", "lps",
                           "--json", "-")
                self.assertEqual(made.returncode, 0, made.stderr)
                self.assertEqual(json.loads(made.stdout)["title"], title)

    def test_a_flag_that_no_option_has_is_told_as_it_was_given(self):
        self.assertIn("--no_such", run(BIN / "palpate-obb", "--no_such", "a.vtp", "-o", "b").stderr)

    def test_a_command_does_what_slicer_calls_with_names_of_several_words(self):
        with tempfile.TemporaryDirectory() as scratch:
            scan, labels, case = (pathlib.Path(scratch) / name for name in ("scan.nrrd", "labels.seg.nrrd", "case.toml"))
            self.assertEqual(run(PHANTOM, "abdomen", scan, labels).returncode, 0)
            text = run(BIN / "palpate-init", "--xml").stdout
            arguments = slicer_arguments(text, {"input": str(labels), "label_names": "1=left_liver", "organ": "left_liver",
                                                "output": str(case)})
            self.assertIn("--label_names", arguments)
            made = run(BIN / "palpate-init", *arguments)
            self.assertEqual(made.returncode, 0, made.stderr)
            self.assertIn("left_liver", case.read_text())


class Judge(unittest.TestCase):
    """What the rules above say of descriptions that are wrong."""

    RIGHT = """<executable><category>a</category><title>a</title><description>a</description><version>1</version><license>a</license>
        <contributor>a</contributor><parameters><label>a</label><description>a</description>
        <file><name>input</name><index>0</index><description>a</description><label>a</label><channel>input</channel></file>
        <double><name>size_mm</name><longflag>--size_mm</longflag><description>a</description><label>a</label><default>2</default></double>
        </parameters></executable>"""

    def test_a_right_one_is_taken(self):
        self.assertEqual(errors_of_module(self.RIGHT), [])
        self.assertEqual(slicer_arguments(self.RIGHT, {"input": "a.nrrd"}), ["--size_mm", "2", "a.nrrd"])

    def test_each_wrong_one_is_refused(self):
        for right, wrong, said in (
                ("--size_mm", "--size-mm", "--size-mm is no identifier"), ("<name>size_mm", "<name>2size", "2size is no identifier"),
                ("<default>2", "<default>", "is no number"), ("<index>0", "<index>1", "places"),
                ("<name>size_mm", "<name>input", "a name twice"),
                ("<index>0</index>", "", "neither"), ("<channel>input", "<channel>both", "channel both"),
                ("<file>", "<file hidden='true'>", "hidden"), ("<title>a</title>", "<titel>a</titel>", "titel"),
                ("double>", "real>", "<real> is no parameter"),
                ("executable>", "module>", "<module> outermost"), ("<label>a</label><description>a</description>\n", "\n", "no parameters")):
            self.assertIn(said, "\n".join(errors_of_module(self.RIGHT.replace(right, wrong))), wrong)


if __name__ == "__main__":
    unittest.main()
