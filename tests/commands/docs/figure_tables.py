# SPDX-License-Identifier: GPL-3.0-or-later
"""Markdown tables of figures, as a page shows them and as a program prints them, and how near one is to the other."""
import math
import re
from dataclasses import dataclass

ALONG = ("circle, mm", "tool, mm", "deep, mm", "T ms", "virtual time, h")  # columns that say, beside the first one, what a row is of
NUMBER = re.compile(r"(?<![\w.])[+-]?\d+(?:\.\d+)?(?:e-?\d+)?(?![\w.]*\d)")
CELL_ENDS = re.compile(r"(?<!\\)\|")


@dataclass(frozen=True)
class Within:
    """How far a figure may be off: by a factor, or by so much. One unit of the last digit that a page gives is never too far, but of a count."""

    factor: float = 1.0
    slack: float = 0.0


FREE = Within(math.inf)  # times and what depends on them: printed, not held


def tables_of(text):
    """(headings, rows) of each table."""
    found, last = [], None
    for line in text.splitlines():
        if not line.startswith("|"):
            last = None
            continue
        row = [cell.strip().strip("*") for cell in CELL_ENDS.split(line.strip())[1:-1]]
        if last is None:
            last = (row, [])
            found.append(last)
        elif not set(line) <= set("|-: "):
            last[1].append(row)
    return found


def cells(text):
    """Of all tables: (what the row is of, heading) -> cell; None where two say something else of the same."""
    found = {}
    for headings, rows in tables_of(text):
        for row in rows:
            named = [k for k, heading in enumerate(headings) if k == 0 or heading in ALONG]
            of = ", ".join(cell for k, cell in enumerate(row) if k in named)
            for k, (heading, cell) in enumerate(zip(headings, row)):
                if k not in named:
                    found[of, heading] = cell if found.get((of, heading), cell) == cell else None
    return found


def unit(number, is_percentage):
    """One of its last digit; none of a count."""
    mantissa, _, exponent = number.partition("e")
    decimals = len(mantissa.partition(".")[2])
    return 10.0 ** (int(exponent or 0) - decimals) if decimals or exponent or is_percentage else 0.0


def near(said, made, within, is_percentage=False):
    a, b = float(said), float(made)
    if abs(a - b) <= max(1.001 * unit(said, is_percentage), within.slack):
        return True
    return a * b > 0 and max(abs(a), abs(b)) <= within.factor * min(abs(a), abs(b))


def agree(said, made, within):
    """True if a cell that was made is what the page says; `within` is one for all of its numbers, or one for each."""
    if within == FREE:
        return True
    if NUMBER.sub("#", said) != NUMBER.sub("#", made):
        return False
    pairs = list(zip(NUMBER.finditer(said), NUMBER.findall(made)))
    bounds = within if isinstance(within, tuple) else (within,) * len(pairs)
    return all(near(a[0], b, bound, said[a.end():].lstrip().startswith("%")) for (a, b), bound in zip(pairs, bounds, strict=True))
