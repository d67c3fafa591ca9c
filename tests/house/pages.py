#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Fails if a page is too long, a link, a path, a picture or a test leads nowhere, a figure is not where the page has it from, or a
command or option is named that does not exist.

pages.py <source folder>                reads the pages alone: length, links, paths, pictures, tests, figures
pages.py <source folder> <programs>     compares commands and options in code with the programs' help

A figure that somebody measured, and every percentage, stands between `<!-- figure: PLACE -->` and `<!-- /figure -->`. PLACE is a file of the
repository, or `benchmarks#section` of tests/benchmarks/README.md, in which the same numbers stand; such a section has the command that
gives them.
"""
import functools
import os
import re
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
sys.dont_write_bytecode = True
from docs.generator import commands  # noqa: E402

MOST_LINES = {"README.md": 120, "docs/tutorials/": 80, "docs/why_believe.md": 120, "docs/not_for.md": 120}
FENCE = re.compile(r"^```(\w*)\n(.*?)^```", re.MULTILINE | re.DOTALL)
PATH = re.compile(r"(?:\./)?((?:formats|tools|runtime|pipelines|tests|docs|sample_data|cmake|\.ci)/[\w./-]*)")
OPTION = re.compile(r"(?<![\w-])(--[a-z][a-z0-9-]*)")
FIGURE = re.compile(r"<!-- figure: (\S+) -->(.*?)<!-- /figure -->", re.DOTALL)
GENERATED = re.compile(r"<!-- [\w ]+: generated -->.*?<!-- end -->", re.DOTALL)
NUMBER = re.compile(r"(?<![\w.])[+-]?\d+(?:\.\d+)?(?:e-?\d+)?(?![\w.]*\d)")
PERCENTAGE = re.compile(r"\d[\d.]* ?%")
TEST_NAME = re.compile(r"`([A-Z]\w+)\.([a-z]\w*_\w+)`")
URL = re.compile(r"\bhttps?:[^\s)>`\"]*")
WHOLE_URL = re.compile(r"https?://[a-z0-9-]+(\.[a-z0-9-]+)+(:\d+)?(/[\w./~%#?=&+,;:@-]*)?", re.IGNORECASE)
BENCHMARKS = "tests/benchmarks/README.md"


def pages(root):
    found = [root / "README.md", root / "CONTRIBUTING.md", root / "CHANGELOG.md", *sorted((root / "docs").rglob("*.md")),
             *sorted((root / "formats").glob("*/SPEC.md")), root / BENCHMARKS,
             root / "tests/fuzz/README.md"]
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


def broken_addresses(text):
    for address in URL.findall(text):
        if not WHOLE_URL.fullmatch(address.rstrip(".,;:")):
            yield f"gives {address}, which is no address of a page"


def section(text, anchor):
    """The section of a page under a heading, with those below it; None where there is no such heading."""
    bare, start, level = FENCE.sub(lambda block: re.sub(r"(?m)^#", " ", block[0]), text), None, 0
    for heading in re.finditer(r"^(#+) (.+)$", bare, re.MULTILINE):
        if start is not None and len(heading[1]) <= level:
            return text[start:heading.start()]
        if start is None and anchor in anchors(heading[0]):
            start, level = heading.start(), len(heading[1])
    return text[start:] if start is not None else None


def stands_in(number, percent, text):
    """True if a place has a number, or its hundredth where it is a percentage."""
    values = {float(found) for found in NUMBER.findall(text)}
    return float(number) in values or percent and any(abs(float(number) / 100 - value) < 1e-12 for value in values)


def false_figures(root, page, text):
    """Figures that do not stand where the page has them from, and percentages from nowhere."""
    for place, figure in FIGURE.findall(text):
        path, _, anchor = place.partition("#")
        path = BENCHMARKS if path == "benchmarks" else path
        if not NUMBER.search(figure):
            yield f"has '{figure}' for a figure, without a number"
        if not (root / path).is_file():
            yield f"has a figure from {path}, which does not exist"
            continue
        source = (root / path).read_text()
        source = section(source, anchor) if anchor else source
        if source is None:
            yield f"has a figure from {place}, but there is no such heading"
        elif path == BENCHMARKS and "```sh" not in source:
            yield f"has a figure from {place}, where no command gives it"
        else:
            for number in NUMBER.finditer(figure):
                if not stands_in(number[0], figure[number.end():].lstrip().startswith("%"), source):
                    yield f"has the figure {number[0]} from {place}, which does not have it"
    if page.startswith("docs/") or page == "README.md":
        rest = re.sub(r"`[^`\n]+`", "", GENERATED.sub("", FIGURE.sub("", FENCE.sub("", text))))
        yield from (f"gives {found}, a percentage that is marked as no figure" for found in PERCENTAGE.findall(rest))


@functools.cache
def tests_of(root):
    """Every GoogleTest case as (suite, case)."""
    return {found for path in (root / "tests").rglob("*.cpp")
            for found in re.findall(r"\bTEST(?:_F|_P)?\((\w+),\s*(\w+)\)", path.read_text())}


def lost_tests(root, text):
    for suite, case in TEST_NAME.findall(text):
        if (suite, case) not in tests_of(root):
            yield f"names the test {suite}.{case}, which does not exist"


def lost_pictures(root):
    """Pictures that no page shows."""
    texts = pages(root)
    shown = {(path.parent / link).resolve() for path, text in texts.items() for link in re.findall(r"\]\(([^)\s#]+)", text)}
    for folder in ("docs/pictures", "tests/benchmarks/pictures"):
        for picture in sorted((root / folder).rglob("*.*")):
            if picture.resolve() not in shown:
                yield f"{picture.relative_to(root)} is shown on no page"


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
        name = str(path.relative_to(root))
        most = next((lines for start, lines in MOST_LINES.items() if name.startswith(start)), None)
        if most and len(text.splitlines()) > most:
            yield f"{name} has {len(text.splitlines())} lines, more than {most}"
        errors = (dead_links(path, text), lost_paths(root, text), broken_addresses(text), false_figures(root, name, text), lost_tests(root, text))
        yield from (f"{name} {error}" for found in errors for error in found)
    yield from lost_pictures(root)


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
