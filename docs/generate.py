#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Fills what is generated in the pages of docs/; with --check says what is stale instead, and fails.

    docs/generate.py [--check] [--root FOLDER] [PART ...]      all parts without one

A part stands in a page between the lines "<!-- PART: generated -->" and "<!-- end -->". `commands` asks the programs in
PALPATE_BIN, build/release/bin without it; the others are read from the source.
"""
import argparse
import difflib
import os
import re
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
sys.dont_write_bytecode = True
from docs.generator import architecture, commands  # noqa: E402


def programs(root):
    return Path(os.environ.get("PALPATE_BIN", root / "build/release/bin"))


# Part of a page -> what makes its text from the source folder.
PARTS = {
    "commands": lambda root: commands.reference(root, programs(root)),
    "picture": architecture.picture,
    "rooms": architecture.table,
}


def place_of(root, part):
    """The page that has a place for a part, and the place as a pattern."""
    pattern = re.compile(rf"(?<=<!-- {part}: generated -->\n).*?(?=\n<!-- end -->)", re.DOTALL)
    pages = [page for page in sorted((root / "docs").glob("*.md")) if pattern.search(page.read_text())]
    if len(pages) != 1:
        sys.exit(f"docs/generate.py: {len(pages)} pages have a place for '{part}', expected one")
    return pages[0], pattern


def fill(root, part, check):
    """Writes a part into its page, or with `check` prints how they differ. Whether they differed."""
    page, pattern = place_of(root, part)
    before, made = page.read_text(), PARTS[part](root)
    after = pattern.sub(lambda _: made, before)
    if before != after and check:
        sys.stdout.writelines(difflib.unified_diff(before.splitlines(True), after.splitlines(True), f"docs/{page.name}", "as generated"))
    elif before != after:
        page.write_text(after)
        print(f"docs/{page.name}: {part} renewed")
    return before != after


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--check", action="store_true", help="change nothing, fail where a page is stale")
    parser.add_argument("--root", type=Path, default=HERE.parent, help="source folder, this one's if not given")
    parser.add_argument("parts", nargs="*", metavar="PART", help=", ".join(PARTS))
    arguments = parser.parse_args()
    if unknown := set(arguments.parts) - PARTS.keys():
        parser.error(f"no part is called {', '.join(sorted(unknown))}")
    parts = arguments.parts or list(PARTS)
    try:
        stale = [part for part in parts if fill(arguments.root, part, arguments.check)]
    except commands.NotBuilt as error:
        print(f"skipped: {error}" if arguments.check else f"docs/generate.py: {error}; build it, or name its folder by PALPATE_BIN")
        return 0 if arguments.check else 1
    if arguments.check:
        print(f"stale: {', '.join(stale)}; run docs/generate.py" if stale else f"{len(parts)} parts are current")
    return 1 if arguments.check and stale else 0


if __name__ == "__main__":
    sys.exit(main())
