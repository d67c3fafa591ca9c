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
import sys
from itertools import pairwise
from pathlib import Path

import matplotlib
import numpy as np
from matplotlib.figure import Figure

INK = "#768390"
# method: label, colour
SERIES = {"exact": ("dense", "#3d84d6"), "hierarchical": ("hierarchical", "#d8732a")}
NODE_TICKS = [200, 500, 1000, 2000, 5000, 10000, 20000, 50000]
STYLE = {"svg.fonttype": "none", "svg.hashsalt": "palpate", "font.size": 9, "axes.titlelocation": "left",
         "axes.grid": True, "axes.grid.axis": "y", "grid.alpha": 0.25, "ytick.left": False,
         **{f"axes.spines.{side}": False for side in ("left", "top", "right")},
         **dict.fromkeys(("text.color", "axes.titlecolor", "axes.labelcolor", "axes.edgecolor", "xtick.color",
                          "ytick.color", "grid.color"), INK)}


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
    """{method: [line]} ascending by nodes, one line a body."""
    best = {}
    for line in lines:
        if line.get("method") not in SERIES or not line["body"].startswith(family):
            continue
        key = (line["method"], line["body"])
        if key not in best or line["seconds"] < best[key]["seconds"]:
            best[key] = line
    ascending = sorted(best.values(), key=lambda line: line["surface_nodes"])
    return {method: found for method in SERIES if (found := [line for line in ascending if line["method"] == method])}


def extended(nodes, values, power, largest):
    """One more point at the largest number of nodes, by the power law that the last measured one is on."""
    if nodes[-1] >= largest:
        return nodes, values
    return np.append(nodes, largest), np.append(values, values[-1] * (largest / nodes[-1]) ** power)


def verdict(dense, hierarchical):
    """From which number of nodes on the hierarchical form costs less, between points by power laws; None if there is no
    such crossing. And which of the two costs less at every size, or None."""
    low, high = (pick(curve[0][end] for curve in (dense, hierarchical)) for pick, end in ((max, 0), (min, -1)))
    nodes = np.array([n for n in np.union1d(dense[0], hierarchical[0]) if low <= n <= high])
    logs = [np.interp(np.log(nodes), np.log(x), np.log(y)) for x, y in (hierarchical, dense)]
    gaps, found = logs[0] - logs[1], None
    for (x0, gap0), (x1, gap1) in pairwise(zip(nodes, gaps)):
        if gap0 > 0 >= gap1:
            found = x0 * (x1 / x0) ** (gap0 / (gap0 - gap1))
        elif gap1 > 0:
            found = None
    always = "hierarchical" if (gaps < 0).all() else "dense" if (gaps > 0).all() else None
    return found, always


def sentence_of(found, always, less):
    if found:
        return f"hierarchical is {less} from {count_text(round(found, -2))} nodes"
    return f"{always} is {less} at every size measured" if always else "neither wins from some size on"


def draw_quantity(axes, series, key, title, less, power, ticks, text_of):
    largest = max(lines[-1]["surface_nodes"] for lines in series.values())
    curves = {}
    for method, lines in series.items():
        nodes, values = (np.array([line[k] for line in lines], float) for k in ("surface_nodes", key))
        colour = SERIES[method][1]
        axes.loglog(nodes, values, "o-", color=colour, linewidth=2, markersize=5)
        measured = len(nodes)
        curves[method] = extended(nodes, values, power, largest) if method == "exact" else (nodes, values)
        axes.loglog(*(part[measured - 1:] for part in curves[method]), ":", color=colour, linewidth=2)
    top = max(curves, key=lambda method: curves[method][1][-1])
    for method, (nodes, values) in curves.items():
        label, colour = SERIES[method]
        about = "≈ " if len(nodes) > len(series[method]) else ""
        # Above the upper end and below the lower one: names keep apart however near the ends are.
        axes.annotate(f"{label}\n{about}{text_of(values[-1])}", (nodes[-1], values[-1]), (8, 0), color=colour,
                      textcoords="offset points", va="bottom" if method == top else "top", annotation_clip=False)
    sentence = "one form only, nothing to compare"
    if len(curves) == 2:
        found, always = verdict(curves["exact"], curves["hierarchical"])
        sentence = sentence_of(found, always, less)
        if found:
            value = np.exp(np.interp(np.log(found), *np.log(curves["exact"])))
            axes.plot(found, value, "o", markersize=11, markerfacecolor="none", color=INK)
            axes.annotate(f"equal at {count_text(round(found, -2))} nodes,\n{text_of(value)}", (found, value), (12, -12),
                          textcoords="offset points", va="top")
    print(f"{title}: {sentence}")
    axes.set_title(f"{title}\n{sentence}", fontsize=10)
    axes.set_xlabel("surface nodes")
    axes.minorticks_off()
    for set_ticks, wanted, (low, high), text in ((axes.set_xticks, NODE_TICKS, axes.get_xlim(), count_text),
                                                 (axes.set_yticks, ticks, axes.get_ylim(), text_of)):
        shown = [tick for tick in wanted if low <= tick <= high]
        set_ticks(shown, [text(tick) for tick in shown])


def draw(series, processor, path):
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(10, 4.7), layout="constrained")
        figure.suptitle("What a surface compliance costs", x=0.01, ha="left", fontsize=13)
        for axes, (key, title, *rest) in zip(figure.subplots(1, 2), QUANTITIES):
            if processor and key == "seconds":
                key, title = "cpu_seconds", "Processor time to build"
            draw_quantity(axes, series, key, title, *rest)
        figure.supxlabel("Points are measured; dotted: the dense form as the cube (time) and the square (size) of the nodes.",
                         x=0.01, ha="left", fontsize=8)
        figure.savefig(path, format="svg", transparent=True, metadata={"Date": None})


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
    parser.add_argument("--table", type=Path, help="Markdown page whose table is replaced; it is printed as well")
    options = parser.parse_args()
    lines = read_lines(options.lines)
    if options.output:
        series = series_of(lines, options.family)
        if not series:
            sys.exit(f"plot_condensation.py: no exact or hierarchical measurement of a body named {options.family}...")
        draw(series, options.processor, options.output)
    if options.table:
        print(table_of(lines))
        write_table(options.table, table_of(lines))


if __name__ == "__main__":
    main()
