#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Fails if rooms or folders include each other in a circle, a folder is overfull, a room does not say what it is, or a
file opens another namespace than its room's.

rooms.py <source folder> [most files in a folder]
"""
import os
import re
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
sys.dont_write_bytecode = True
from docs.generator import source_tree  # noqa: E402

MOST_FILES = 25
FOLDERS = (*source_tree.HALLS, "tests", "docs", "pipelines", "sample_data", "cmake")
NOT_OURS = {"__pycache__", "cache", ".snakemake"}
VOCABULARY = {"formats/model", "formats/records"}  # what every room says is in palpate itself
DECLARED_AHEAD = {"CLI"}  # so that this library's headers stay out of ours
NAMESPACE = re.compile(r"^(?:inline )?namespace ([\w:]+) \{", re.MULTILINE)


def overfull(root, most):
    errors = []
    for top in FOLDERS:
        for folder, inner, files in os.walk(root / top):
            inner[:] = sorted(set(inner) - NOT_OURS)
            if len(files) > most:
                errors.append(f"{Path(folder).relative_to(root)} has {len(files)} files, more than {most}")
    return errors


def circles(root):
    return [f"{what} include each other in a circle: {' -> '.join(path)}"
            for what, edges in (("rooms", source_tree.room_edges(root)), ("folders", source_tree.folder_edges(root)))
            if (path := source_tree.cycle(edges))]


def strangers(root):
    """Files whose outermost namespace, or any of palpate's that they open, is neither their room's nor inside it."""
    errors = []
    for path in source_tree.sources(root):
        room = source_tree.room_of(path)
        home = "palpate" if room in VOCABULARY else f"palpate::{room.split('/')[1]}"
        opened = [name for name in NAMESPACE.findall((root / path).read_text()) if name not in DECLARED_AHEAD]
        for name in dict.fromkeys(opened[:1] + [name for name in opened if name.split("::")[0] == "palpate"]):
            if name != home and (room in VOCABULARY or not name.startswith(f"{home}::")):
                errors.append(f"{path} opens namespace {name}; its room's is {home}")
    return errors


def main(root, most):
    rooms = source_tree.room_names(root)
    errors = circles(root) + overfull(root, most) + strangers(root)
    errors += [f"{room}/CMakeLists.txt does not say in its second line what the room is, as '# ...'"
               for room in rooms if source_tree.purpose(root, room) is None]
    for error in errors:
        print(error)
    print(f"{len(rooms)} rooms read, {len(errors)} errors")
    return 1 if errors or not rooms else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else MOST_FILES))
