#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws how the cost of a compliance grows with the surface, and tabulates its figures.

    tests/benchmarks/plot_condensation.py LINES.jsonl [LINES.jsonl ...] [-o condensation_growth.svg] [--table README.md]

Reads the lines of bench_condensation --json: of method "exact" (dense) and "hierarchical", the keys surface_nodes,
seconds and bytes. Of a body measured several times the fastest counts. Colours are chosen to read on white and on
near-black, because the page decides. Lines with a figure become the page's table, where what misses its limit is bold.
"""
import argparse
import json
import math
import sys
from html import escape
from itertools import pairwise
from pathlib import Path

# method, label, colour
SERIES = [("exact", "dense", "#3d84d6"), ("hierarchical", "hierarchical", "#d8732a")]
INK, FAINT = "#768390", "#8b949e"
WIDTH, HEIGHT = 960, 450
PANEL = {"top": 92, "height": 280, "width": 320}
NODE_TICKS = [200, 500, 1000, 2000, 5000, 10000, 20000, 50000]


def in_units(value, units):
    """With two digits, or all before the point: "0.13 s", "17 min", "278 MB"."""
    unit, size = next(((unit, size) for unit, size in units if value >= size), units[-1])
    return f"{value / size:.0f} {unit}" if value >= 9.95 * size else f"{value / size:.2g} {unit}"


def seconds_text(value):
    return in_units(value, [("h", 3600), ("min", 60), ("s", 1)])


def bytes_text(value):
    return in_units(value, [("GB", 1e9), ("MB", 1e6), ("kB", 1e3)])


def count_text(value):
    return f"{value:,.0f}".replace(",", " ")


# key, title, what less of it is called, power that a dense matrix grows with, ticks, text of a value
QUANTITIES = [
    ("seconds", "Time to build", "faster", 3, [0.01, 0.1, 1, 10, 60, 600, 3600, 36000], seconds_text),
    ("bytes", "Size in an asset", "smaller", 2, [10.0**k for k in range(3, 13)], bytes_text),
]


def read_lines(paths):
    return [json.loads(words) for path in paths for words in path.read_text().splitlines()]


def series_of(lines, family):
    """{method: [(nodes, line)]} ascending by nodes, one line a body."""
    best = {}
    for line in lines:
        if "method" not in line or not line["body"].startswith(family):
            continue
        key = (line["method"], line["body"])
        if key not in best or line["seconds"] < best[key]["seconds"]:
            best[key] = line
    series = {}
    for (method, _), line in best.items():
        series.setdefault(method, []).append((line["surface_nodes"], line))
    return {method: sorted(points, key=lambda point: point[0]) for method, points in series.items()}


def extended(points, power, nodes):
    """The points, and one more at `nodes` by the power law that the last measured one is on."""
    last_nodes, last = points[-1]
    return [*points, (nodes, last * (nodes / last_nodes) ** power)] if nodes > last_nodes else points


def value_at(points, nodes):
    """Interpolates between points as a power law; None outside them."""
    for (x0, y0), (x1, y1) in pairwise(points):
        if x0 <= nodes <= x1:
            share = math.log(nodes / x0) / math.log(x1 / x0)
            return y0 * (y1 / y0) ** share
    return None


def crossover(dense, hierarchical):
    """The number of nodes from which the hierarchical form stays below the dense one, and the value there; None if
    that never happens or is so from the first common size on."""
    common = sorted({x for x, _ in dense + hierarchical})
    common = [x for x in common if value_at(dense, x) and value_at(hierarchical, x)]
    gaps = [(x, math.log(value_at(hierarchical, x) / value_at(dense, x))) for x in common]
    found = None
    for (x0, gap0), (x1, gap1) in pairwise(gaps):
        if gap0 > 0 >= gap1:
            nodes = x0 * (x1 / x0) ** (gap0 / (gap0 - gap1))
            found = nodes, value_at(dense, nodes)
        elif gap1 > 0:
            found = None
    return found


class Panel:
    """One log-log diagram; maps nodes and values to the picture."""

    def __init__(self, left, nodes, values):
        self.left, self.right = left, left + PANEL["width"]
        self.top, self.bottom = PANEL["top"], PANEL["top"] + PANEL["height"]
        self.nodes = (nodes[0] / 1.15, nodes[1] * 1.15)
        self.values = (values[0] / 1.6, values[1] * 1.6)

    def x(self, nodes):
        low, high = self.nodes
        return self.left + (self.right - self.left) * math.log(nodes / low) / math.log(high / low)

    def y(self, value):
        low, high = self.values
        return self.bottom - (self.bottom - self.top) * math.log(value / low) / math.log(high / low)

    def path(self, points):
        return "M" + " L".join(f"{self.x(nodes):.1f} {self.y(value):.1f}" for nodes, value in points)


def text(x, y, words, size=13, colour=INK, anchor="start", weight="normal"):
    return (f'<text x="{x:.1f}" y="{y:.1f}" font-size="{size}" fill="{colour}" text-anchor="{anchor}" '
            f'font-weight="{weight}">{escape(words)}</text>')


def draw_axes(panel, title, sentence, ticks, text_of):
    parts = [text(panel.left, panel.top - 32, title, 15, INK, weight="600"),
             text(panel.left, panel.top - 14, sentence, 12)]
    for tick in ticks:
        if panel.values[0] <= tick <= panel.values[1]:
            y = panel.y(tick)
            parts.append(f'<path d="M{panel.left} {y:.1f} H{panel.right}" stroke="{FAINT}" stroke-opacity="0.25"/>')
            parts.append(text(panel.left - 8, y + 4, text_of(tick), 12, anchor="end"))
    for tick in NODE_TICKS:
        if panel.nodes[0] <= tick <= panel.nodes[1]:
            x = panel.x(tick)
            parts.append(f'<path d="M{x:.1f} {panel.bottom} v5" stroke="{FAINT}" stroke-opacity="0.6"/>')
            parts.append(text(x, panel.bottom + 20, count_text(tick), 12, anchor="middle"))
    parts.append(f'<path d="M{panel.left} {panel.bottom} H{panel.right}" stroke="{FAINT}" stroke-opacity="0.6"/>')
    parts.append(text((panel.left + panel.right) / 2, panel.bottom + 42, "surface nodes", 12, anchor="middle"))
    return parts


def draw_series(panel, points, measured, colour, label, text_of, lift):
    """Measured points with a line, its extrapolation dashed, the name and the last value at the end, lifted."""
    parts = [f'<path d="{panel.path(points[:measured])}" fill="none" stroke="{colour}" stroke-width="2.5" '
             'stroke-linejoin="round"/>']
    if measured < len(points):
        parts.append(f'<path d="{panel.path(points[measured - 1:])}" fill="none" stroke="{colour}" '
                     'stroke-width="2" stroke-dasharray="2 5" stroke-linecap="round"/>')
    parts += [f'<circle cx="{panel.x(nodes):.1f}" cy="{panel.y(value):.1f}" r="3.5" fill="{colour}"/>'
              for nodes, value in points[:measured]]
    nodes, value = points[-1]
    x, y = panel.x(nodes) + 10, panel.y(value) + 4 - lift
    parts.append(text(x, y, label, 13, colour, weight="600"))
    parts.append(text(x, y + 15, text_of(value) if measured == len(points) else f"≈ {text_of(value)}", 12, colour))
    return parts


def draw_crossover(panel, nodes, value, text_of):
    """A ring where the curves cross, named below them, where neither runs."""
    x, y = panel.x(nodes), panel.y(value)
    return [f'<circle cx="{x:.1f}" cy="{y:.1f}" r="7" fill="none" stroke="{INK}" stroke-width="1.5"/>',
            f'<path d="M{x:.1f} {y + 8:.1f} V{y + 30:.1f}" stroke="{INK}" stroke-opacity="0.7"/>',
            text(x - 4, y + 45, f"equal at {count_text(round(nodes, -2))} nodes", 12, INK, weight="600"),
            text(x - 4, y + 60, text_of(value), 12, INK)]


def verdict(curves, less, text_of):
    """The crossover, and one sentence about it."""
    if len(curves) < 2:
        return None, ""
    dense, hierarchical = curves["exact"], curves["hierarchical"]
    found = crossover(dense, hierarchical)
    if found:
        return found, f"hierarchical is {less} from {count_text(round(found[0], -2))} nodes, {text_of(found[1])}"
    wins = {value < value_at(dense, nodes) for nodes, value in hierarchical if value_at(dense, nodes)}
    if len(wins) != 1:
        return None, "neither wins from some size on"
    return None, f"{'hierarchical' if wins == {True} else 'dense'} is {less} at every size measured"


def lifts(panel, curves):
    """How far each curve's name must go up or down so that names at nearly the same height keep apart."""
    height = 34
    ends = sorted(curves, key=lambda method: panel.y(curves[method][-1][1]))
    if len(ends) < 2:
        return dict.fromkeys(ends, 0)
    gap = panel.y(curves[ends[1]][-1][1]) - panel.y(curves[ends[0]][-1][1])
    return {ends[0]: max(0, height - gap) / 2, ends[1]: -max(0, height - gap) / 2}


def draw_quantity(left, series, key, title, less, power, ticks, text_of):
    curves = {method: [(nodes, line[key]) for nodes, line in points] for method, points in series.items()}
    measured = {method: len(points) for method, points in curves.items()}
    largest = max(points[-1][0] for points in curves.values())
    if "exact" in curves:
        curves["exact"] = extended(curves["exact"], power, largest)
    every = [point for points in curves.values() for point in points]
    nodes, values = [point[0] for point in every], [point[1] for point in every]
    panel = Panel(left, (min(nodes), max(nodes)), (min(values), max(values)))
    found, sentence = verdict(curves, less, text_of)
    print(f"{title}: {sentence or 'one form only, nothing to compare'}")
    parts = draw_axes(panel, title, sentence, ticks, text_of)
    lift = lifts(panel, curves)
    for method, label, colour in SERIES:
        if method in curves:
            parts += draw_series(panel, curves[method], measured[method], colour, label, text_of, lift[method])
    if found:
        parts += draw_crossover(panel, *found, text_of)
    return parts


def draw(series, processor):
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" width="{WIDTH}" '
             f'height="{HEIGHT}" font-family="system-ui, -apple-system, Segoe UI, Helvetica, Arial, sans-serif" '
             'role="img" aria-label="Time and size of a surface compliance against surface nodes">']
    parts.append(text(18, 28, "What a surface compliance costs", 18, INK, weight="600"))
    for left, (key, title, *rest) in zip((72, 542), QUANTITIES):
        if processor and key == "seconds":
            key, title = "cpu_seconds", "Processor time to build"
        parts += draw_quantity(left, series, key, title, *rest)
    parts.append(text(18, HEIGHT - 8, "Points are measured; dotted: the dense form as the cube (time) and the square "
                                      "(size) of the nodes.", 11))
    return "\n".join([*parts, "</svg>"]) + "\n"


def table_of(lines):
    """One row a figure, one column a body; of a body in several files the last counts. Where the limit depends on the
    size, all that apply are named."""
    figures = [line for line in lines if "figure" in line]
    cells = {(line["figure"], line["body"]): line for line in figures}
    bodies = sorted({(line["body"].split("_")[0] != "uniform", line["body"].split("_")[0], line["surface_nodes"],
                      line["body"]) for line in figures})

    def cell(figure, body):
        line = cells.get((figure, body))
        if not line:
            return "–"
        words = f"{line['value']:,.0f}".replace(",", " ") if line["value"] >= 100 else f"{line['value']:.2g}"
        return words if line.get("met", True) else f"**{words}**"

    rows = [["", "limit"] + [f"{kind} {count_text(nodes)}" for _, kind, nodes, _ in bodies],
            ["---", "--:"] + ["--:"] * len(bodies)]
    for figure in dict.fromkeys(line["figure"] for line in figures):
        limits = dict.fromkeys(line["limit"] for line in figures if line["figure"] == figure and line["limit"])
        limit = ", ".join(limits).replace("<=", "≤").replace(">=", "≥")
        rows.append([figure, limit or "–"] + [cell(figure, body) for _, _, _, body in bodies])
    return "\n".join("| " + " | ".join(row) + " |" for row in rows)


def write_table(page, table):
    """Puts the table between the page's two comments for it."""
    begin, end = "<!-- table of bench_condensation -->", "<!-- end of table -->"
    before, found, rest = page.read_text().partition(begin)
    _, ended, after = rest.partition(end)
    if not found or not ended:
        sys.exit(f"plot_condensation.py: {page} has no '{begin}' ... '{end}'")
    page.write_text(f"{before}{begin}\n{table}\n{end}{after}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("lines", nargs="+", type=Path, help="files of bench_condensation --json")
    parser.add_argument("-o", "--output", type=Path, help="SVG to write")
    parser.add_argument("--family", default="graded", help="drawn: bodies whose names begin so [default: graded]")
    parser.add_argument("--processor", action="store_true",
                        help="draw the processor's seconds: for a machine that other work shares")
    parser.add_argument("--table", type=Path, help="Markdown page whose table is replaced")
    options = parser.parse_args()
    lines = read_lines(options.lines)
    series = series_of(lines, options.family)
    series = {method: series[method] for method, _, _ in SERIES if method in series}
    if options.output and not series:
        sys.exit(f"plot_condensation.py: no exact or hierarchical measurement of a body named {options.family}...")
    if options.output:
        options.output.write_text(draw(series, options.processor))
    if options.table:
        write_table(options.table, table_of(lines))


if __name__ == "__main__":
    main()
