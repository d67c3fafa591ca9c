#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Fails if a page is too long, a link or a path leads nowhere, or a command or option is named that does not exist.

pages.py <source folder>                reads the pages alone: length, links, paths
pages.py <source folder> <programs>     compares commands and options in code with the programs' help
"""
import os
import re
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
sys.dont_write_bytecode = True
from docs.generator import commands  # noqa: E402

MOST_LINES = 120  # of README.md
FENCE = re.compile(r"^```(\w*)\n(.*?)^```", re.MULTILINE | re.DOTALL)
PATH = re.compile(r"(?:\./)?((?:formats|tools|runtime|pipelines|tests|docs|sample_data|cmake|\.ci)/[\w./-]*)")
OPTION = re.compile(r"(?<![\w-])(--[a-z][a-z0-9-]*)")


def pages(root):
    found = [root / "README.md", root / "CONTRIBUTING.md", *sorted((root / "docs").glob("*.md")), root / "tests/benchmarks/README.md"]
    return {path: path.read_text() for path in found if path.exists()}


def anchors(text):
    """The names that GitHub gives to headings."""
    headings = re.findall(r"^#+ (.+)$", FENCE.sub("", text), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).strip().replace(" ", "-") for heading in headings}


def dead_links(path, text):
    for link in re.findall(r"\]\(([^)\s]+)\)", FENCE.sub("", text)):
        target, _, anchor = link.partition("#")
        place = path.parent / target if target else path
        if re.match(r"[a-z]+:", link):
            continue
        if not place.exists():
            yield f"links to {link}, which does not exist"
        elif anchor and anchor not in anchors(place.read_text()):
            yield f"links to {link}, but {place.name} has no such heading"


def code(text):
    """Lines of code in a page: those of shell blocks, joined where they go on, and what stands in back quotes."""
    for language, block in FENCE.findall(text):
        if language == "sh":
            yield from block.replace("\\\n", " ").splitlines()
    yield from re.findall(r"`([^`\n]+)`", FENCE.sub("", text))


def lost_paths(root, text):
    for line in code(text):
        for path in PATH.findall(line) if re.match(r"(\S*\s+)?" + PATH.pattern, line) else ():
            if not (root / path.rstrip(".")).exists():
                yield f"names {path}, which does not exist"


def unknown_words(line, options):
    """What a line of code calls that no command has; `options` maps each command to its options."""
    line = line.partition(" #")[0]
    words = re.sub(r"'[^']*'|\"[^\"]*\"", "TEXT", line).split()
    program = words[0].rpartition("/")[2].removeprefix("palpate-") if words else ""
    if program == "palpate" and len(words) > 1 and re.fullmatch(r"[a-z]+", words[1]):
        program = words[1]
        if program not in options:
            yield f"names 'palpate {program}', which is no command"
            return
    known = options.get(program)
    if known is None and line.startswith("--"):
        known, program = set().union(*options.values()), "any command"
    for option in OPTION.findall(" ".join(words)) if known is not None else ():
        if option not in known:
            yield f"gives {option}, which is no option of {program}"


def unknown_commands(text, options):
    for line in code(text):
        yield from unknown_words(line, options)


def read_pages(root):
    for path, text in pages(root).items():
        name = path.relative_to(root)
        if str(name) == "README.md" and len(text.splitlines()) > MOST_LINES:
            yield f"{name} has {len(text.splitlines())} lines, more than {MOST_LINES}"
        yield from (f"{name} {error}" for error in [*dead_links(path, text), *lost_paths(root, text)])


def read_commands(root, programs):
    names = commands.command_names(root)
    options = {name: commands.option_names(commands.help_of(programs, name)) for name in names}
    for path, text in pages(root).items():
        yield from (f"{path.relative_to(root)} {error}" for error in unknown_commands(text, options))


def main(root, programs=None):
    try:
        errors = list(read_commands(root, programs) if programs else read_pages(root))
    except commands.NotBuilt as error:
        print(f"skipped: {error}")
        return 0
    for error in errors:
        print(error)
    print(f"{len(pages(root))} pages read, {len(errors)} errors")
    return 1 if errors or not pages(root) else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]).resolve(), *(Path(os.path.abspath(folder)) for folder in sys.argv[2:])))
