# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes figures of tests/benchmarks/README.md again that other pages quote: by the commands of their section, as they stand there."""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass, field

from figure_sections import SECTIONS
from figure_tables import FREE, agree, cells
from page_blocks import blocks_of

SOURCE = pathlib.Path(os.environ.get("PALPATE_SOURCE", pathlib.Path(__file__).resolve().parents[3]))
BUILD = pathlib.Path(os.environ.get("PALPATE_BUILD", SOURCE / "build/release"))
BIN = pathlib.Path(os.environ.get("PALPATE_BIN", BUILD / "bin"))
sys.path.insert(0, str(SOURCE / "tests/house"))
import pages  # noqa: E402

# What a line needs, by words of it, and whether it is there.
NEEDS = {"build/demo": ("build/demo, which pipelines/demo.sh makes", lambda: (SOURCE / "build/demo/liver.vtkhdf").exists()),
         "sample_data|skull.vtp": ("build/sample_data, which sample_data/unpack.py makes", lambda: (SOURCE / "build/sample_data/head_ct.nrrd").exists()),
         "brain": ("PALPATE_DATA", lambda: "PALPATE_DATA" in os.environ),
         "CalculiX|large_deformation.py": ("calculix-ccx", lambda: shutil.which("ccx"))}


def own_section(text, name):
    """A section without those below it."""
    whole = pages.section(text, name)
    bare = pages.FENCE.sub(lambda block: " " * len(block[0]), whole)
    below = re.compile(r"^#+ ", re.MULTILINE).search(bare, len(bare.partition("\n")[0]))
    return whole[: below.start()] if below else whole


def quotations(root=SOURCE):
    """Section -> (page, figure) of each figure that another page has from it."""
    found = {}
    for path, text in pages.pages(root).items():
        for place, figure in pages.FIGURE.findall(text):
            if place.startswith("benchmarks#"):
                found.setdefault(place.partition("#")[2], []).append((str(path.relative_to(root)), figure))
    return found


def commands(text, shorter):
    """Lines of a section's shell blocks, joined where they go on, with `shorter`'s words in place of theirs."""
    for block in blocks_of(pages.BENCHMARKS, text):
        for line in block.code.replace("\\\n", " ").splitlines():
            for words, instead in shorter.items():
                line = line.replace(words, instead)
            yield line


def workshop(folder):
    """A folder that looks like the source with its build, for commands that write beside what they read."""
    shutil.copytree(SOURCE / "tests/benchmarks", folder / "tests/benchmarks")
    (folder / "build").mkdir()
    for name in ("CMakeLists.txt", "CMakePresets.json", "pipelines", "sample_data", "build/demo", "build/sample_data"):
        (folder / name).symlink_to(SOURCE / name)
    (folder / "build/release").symlink_to(BUILD)


def run(line, folder):
    """What a command says, without the numbers of ctest before its tests' lines. Throws RuntimeError."""
    path = os.pathsep.join(map(str, (BIN, BUILD / "tests", pathlib.Path(sys.executable).parent, os.environ["PATH"])))
    ended = subprocess.run(["bash", "-euo", "pipefail", "-c", line], cwd=folder, env=os.environ | {"PATH": path, "PALPATE_BIN": str(BIN)},
                           stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if ended.returncode:
        raise RuntimeError(f"exit code {ended.returncode} of\n{line}\nwhich said\n{ended.stdout[-4000:]}")
    return re.sub(r"(?m)^\d+: ", "", ended.stdout)


@dataclass
class Remade:
    """Figures of a section made anew."""

    rows: list = field(default_factory=list)  # what came out
    errors: list = field(default_factory=list)  # what is wrong
    skipped: list = field(default_factory=list)  # commands that did not run, and why
    unmade: int = 0  # quoted figures that those would give
    at_length: int = 0  # quoted figures that the commands give when they are not shortened


def quoted_in(figure, shown, places):
    """True if every number of a figure stands in these cells, in what they are of or above them."""
    text = "\n".join(f"{row} | {heading} | {shown[row, heading]}" for row, heading in places)
    return all(pages.stands_in(number[0], figure[number.end():].lstrip().startswith("%"), text) for number in pages.NUMBER.finditer(figure))


def compare(section, text, made, quoted, skipped=(), everything=False):
    """Holds what was made against a section's text and what other pages have from it."""
    result, shown = Remade(skipped=list(skipped)), cells(text)
    remade = [place for place in made if place in shown]
    for row, heading in remade:
        said, cell, bound = shown[row, heading], made[row, heading], section.bound(row, heading)
        if said is None or cell is None:
            result.errors.append(f"{row}, {heading}: more than one cell")
        elif said != cell:
            off = not agree(said, cell, bound)
            result.rows.append(f"{row}, {heading}: {said} on the page, {cell} now{', free' if bound == FREE else ''}{', TOO FAR' if off else ''}")
            result.errors += [f"{row}, {heading}: the page has {said}, and it came out {cell}. {section.why}"] if off else []
    result.rows.append(f"{sum(shown[place] == made[place] for place in remade)} of {len(remade)} cells as they stand; "
                       f"{len(shown) - len(remade)} more are on the page and were not made")
    later = [] if everything else [place for place in shown if place[0] in section.at_length]
    for page, figure in quoted:
        if quoted_in(figure, shown, remade):
            continue
        if quoted_in(figure, shown, later):
            result.at_length += 1
        elif skipped:
            result.unmade += 1
        else:
            result.errors.append(f"{page} has {figure}, which no command of the section makes")
    return result


def remake(name, quoted, everything=False):
    """Runs the commands of a section and compares; all of them at full length if `everything` is asked for."""
    if name not in SECTIONS:
        return Remade(errors=[f"nothing is said in figure_sections.py of {name}, which {quoted[0][0]} quotes"])
    section, text = SECTIONS[name], own_section((SOURCE / pages.BENCHMARKS).read_text(), name)
    said, skipped = "", []
    with tempfile.TemporaryDirectory(prefix="figures.") as folder:
        workshop(pathlib.Path(folder))
        for line in commands(text, {} if everything else section.shorter):
            missing = next((what for words, (what, there) in NEEDS.items() if re.search(words, line) and not there()), None)
            if missing:
                skipped.append(f"not run, for want of {missing}: {line}")
                continue
            started = time.monotonic()
            try:
                said += (printed := run(line, folder)) + "\n"
            except RuntimeError as error:
                return Remade(errors=[str(error)], skipped=skipped)
            print(f"{name}: {time.monotonic() - started:.0f} s: {line}", *(row for row in printed.splitlines() if row.startswith("|")), sep="\n", flush=True)
    return compare(section, text, cells(section.tables(said)), quoted, skipped, everything)
