# SPDX-License-Identifier: GPL-3.0-or-later
"""How near the figures of each section of tests/benchmarks/README.md have to come out again that another page quotes, and why."""
import re
from collections.abc import Callable
from dataclasses import dataclass, field

from figure_tables import FREE, Within

DIGITS = Within(1.02)  # virtual time and drawn numbers are the same everywhere; compilers round differently
SNAPS = Within(2.0)  # the worst of some places, where a tool snaps: a last digit decides when
ROUND_OFF = Within(3.0)  # what is left of 1e-16 after some thousand operations, in whatever order a library does them


def as_printed(said):
    return said


@dataclass(frozen=True)
class Section:
    why: str
    within: Within = DIGITS
    special: dict = field(default_factory=dict)  # row or heading -> Within, or one for each number of a cell
    tables: Callable[[str], str] = as_printed  # what the commands said -> Markdown tables
    shorter: dict = field(default_factory=dict)  # what is said in a command, if not all is asked for -> what is instead
    at_length: tuple = ()  # rows that are not made then

    def bound(self, row, heading):
        return self.special.get(row, self.special.get(heading, self.within))


def elements(said):
    """What the tests of elements print, in the order of their names."""
    tubes = re.findall(r"around 16, nu .*: (.*)", said)
    spheres = re.findall(r"force over Hertz's, exponent: (\S+) (\S+)", said)
    presses = re.findall(r"^sparse: relative .*: (\S+) (\S+) (\S+)", said, re.MULTILINE)
    tables = [("Poisson's ratio | 0.3 | 0.45 | 0.49 | 0.499 | 0.4999", ("linear", "quadratic"),
               [" | ".join(f"{float(part):.3f}" for part in row.split()) for row in tubes]),
              ("element | force", ("linear", "quadratic"), [f"{float(least):.2f} to {float(most):.2f}" for least, most in spheres]),
              ("CalculiX' element | displacements | reactions | force on the tool", ("C3D4", "C3D10"),
               [" | ".join(f"{float(part):.1e}" for part in row) for row in presses])]
    return "\n\n".join("\n".join(f"| {row} |" for row in (headings, *(f"{name} | {row}" for name, row in zip(names, rows)))) for headings, names, rows in tables)


def passivity(said):
    """The tables after that of all trials, whose rows are of the same periods."""
    first = "| T, ms |"
    return first + said.partition(first)[2]


WORK = "work of what was stored: median / 90 % / most"
STEP = "largest step of the largest force: median / most"
LOOPS = {WORK: (Within(1.1), Within(1.5), SNAPS), STEP: (Within(1.1), SNAPS), "loops in contact": Within(slack=1)}

SECTIONS = {
    "condensation": Section("Residuals are round-off. Times and memory are the machine's.", FREE,
                            dict.fromkeys(("residual in double", "residual as stored"), ROUND_OFF),
                            shorter={"condensation_bodies BODIES": "condensation_bodies BODIES uniform_3000 graded_2300 graded_5000",
                                     "--bodies": "--methods exact --repeats 1 --bodies"}),
    "elements": Section("Static solutions on meshes by formula; what CalculiX differs by is the digits that it writes.",
                        special=dict.fromkeys(("displacements", "reactions", "force on the tool"), ROUND_OFF), tables=elements),
    "large-deformation": Section("Static solutions on a mesh by formula, to the digits that CalculiX writes."),
    "large-deformation-in-the-tick": Section(
        "Virtual time; answers come a fixed number of ticks late. The most of some places may be one that snaps. Times are the machine's.",
        special=LOOPS | dict.fromkeys(("moving", "linear"), (Within(1.1), Within(1.3))) |
        {"held": Within(slack=0.01), "largest step while held": SNAPS} | dict.fromkeys(("factor, s", "two steps, ms", "of the period"), FREE)),
    "closed-loops": Section("Virtual time. The most of forty places may be one where the tool snaps.", special=LOOPS),
    "stiffness-under-the-tool": Section("Virtual time. A place near a bound may change sides.",
                                        special=dict.fromkeys(("places", "within 10 %", "within 20 %"), Within(slack=1))),
    "punctures": Section("A seed draws the same approaches everywhere; one that ends at the rule's bound may change sides, but with `continuous` none is lost.",
                         special={"continuous": Within(), "punctures in 100": Within(slack=1), "expected per group": Within(slack=0.1),
                                  "95 % interval of the chance": Within(1.3, slack=0.3)}),
    "passivity": Section("A bisection to 0.05 % in virtual time.", tables=passivity),
    "faults": Section("A seed draws the same faults everywhere; none may be missed.", shorter={"bench faults": "bench faults --seconds 7200"},
                      at_length=("nasopharynx, 12.0", "liver, 12.0")),
    "a-blind-search": Section("A seed draws the same places everywhere; meshes differ by round-off.", Within(1.1),
                              shorter={"blind_search.py": "blind_search.py --draws 2"},
                              at_length=("tumour found, 10 draws", "without a tumour, said none, 10 draws")),
}
