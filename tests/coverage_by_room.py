#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Prints llvm-cov's summary room by room. Ends with 1 if a hall has less than it should.

coverage_by_room.py SUMMARY.json
"""
import json
import sys
from collections import Counter
from pathlib import Path, PurePosixPath

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))
sys.dont_write_bytecode = True
from docs.generator import source_tree  # noqa: E402

HALLS = ("formats", "runtime")
LEAST = 90  # % of lines
SHOWN_BELOW = 75  # % of a file's lines


def main(summary):
    lines, ran, poor = Counter(), Counter(), []
    for file in json.loads(Path(summary).read_text())["data"][0]["files"]:
        path = PurePosixPath(Path(file["filename"]).resolve().relative_to(ROOT))
        counted = file["summary"]["lines"]
        for place in (source_tree.room_of(path), path.parts[0]):
            lines[place] += counted["count"]
            ran[place] += counted["covered"]
        if counted["percent"] < SHOWN_BELOW:
            poor.append((counted["count"] - counted["covered"], f"{path}: {counted['covered']} of {counted['count']}"))
    rooms = [room for room in source_tree.room_names(ROOT) if room.startswith(tuple(f"{hall}/" for hall in HALLS))]
    for place in [*(room for room in rooms if lines[room]), *HALLS]:
        print(f"{place:24} {ran[place]:6} of {lines[place]:6} lines {100 * ran[place] / lines[place]:5.1f} %")
    for _, line in sorted(poor, reverse=True)[:20]:
        print(f"  few of {line}")
    print("not built here: " + (", ".join(room for room in rooms if not lines[room]) or "nothing"))
    return 1 if any(100 * ran[hall] < LEAST * lines[hall] for hall in HALLS) else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
