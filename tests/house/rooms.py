#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Fails if rooms or folders include each other in a circle, a folder is overfull, or a room does not say what it is.

rooms.py <source folder> [most files in a folder]
"""
import os
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
sys.dont_write_bytecode = True
from docs.generator import source_tree  # noqa: E402

MOST_FILES = 25
FOLDERS = (*source_tree.HALLS, "tests", "docs", "pipelines", "sample_data", "cmake")
NOT_OURS = {"__pycache__", "cache", ".snakemake"}


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


def main(root, most):
    rooms = source_tree.room_names(root)
    errors = circles(root) + overfull(root, most)
    errors += [f"{room}/CMakeLists.txt does not say in its second line what the room is, as '# ...'"
               for room in rooms if source_tree.purpose(root, room) is None]
    for error in errors:
        print(error)
    print(f"{len(rooms)} rooms read, {len(errors)} errors")
    return 1 if errors or not rooms else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else MOST_FILES))
