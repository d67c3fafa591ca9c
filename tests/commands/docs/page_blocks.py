# SPDX-License-Identifier: GPL-3.0-or-later
"""The code blocks of a Markdown page: what they are in, what stands above them, and what they are said to print.

An HTML comment in the line above a block is not seen by readers and tells the test about it:

    <!-- not run: WHY -->       it cannot run in a test
    <!-- slow: WHY -->          it runs in the slow tests alone
    <!-- window -->             each of its lines opens a window, which closes at Q
    <!-- clicks -->             the same, after a click in the middle of its first slice and S
    <!-- examples: WHERE -->    each of its lines is an example by itself, which that test runs
    <!-- exit N: WHY -->        its last line ends with that code
    <!-- not output: WHY -->    of a text block: it is not what the block before it prints

Near the top of a page `<!-- starts from: OTHER.md -->` says that its reader has what that page leaves behind.
"""
import re
from dataclasses import dataclass

FENCE = re.compile(r"^```(\w*)\n(.*?)^```", re.MULTILINE | re.DOTALL)
REMARK = re.compile(r"<!-- (not run|slow|window|clicks|examples|exit \d+|not output)(?:: (.+?))? -->\n\Z")
LANGUAGES = ("sh", "python")  # that run
# What differs by machine: times and sizes of memory.
VARIES = re.compile(r"(?<![\w.])\d[\d.]*(?= ?(?:us|µs|ms|s|min|MB|GB|MB/s)\b)")
NUMBER = re.compile(r"(?<![\w.])-?\d+(?:\.\d+)?(?:e-?\d+)?(?![\w.]*\d)")
TOLERANCE = 0.02  # of the larger of two numbers: libraries round differently on other processors


class BadPage(Exception):
    pass


@dataclass
class Block:
    page: str
    line: int  # of its fence; 0 if it is on no page
    language: str
    code: str
    remark: str = ""  # what the comment above it begins with
    reason: str = ""
    output: str | None = None  # what it is said to print

    def __str__(self):
        return f"{self.page}:{self.line}" if self.line else self.page


def blocks_of(page, text):
    """Blocks that run or say why not, in order. Throws BadPage."""
    blocks, last = [], None
    for found in FENCE.finditer(text):
        line = text.count("\n", 0, found.start()) + 1
        block = Block(page, line, found[1], found[2])
        if above := REMARK.search(text[:found.start()]):
            block.remark, block.reason = above[1], above[2] or ""
        if block.remark in ("not run", "slow", "examples", "not output") and not block.reason:
            raise BadPage(f"{block}: '{block.remark}' needs a reason")
        if block.language in LANGUAGES:
            blocks.append(block)
        elif block.language == "text" and block.remark != "not output":
            if last is None or last.language not in LANGUAGES or last.output is not None:
                raise BadPage(f"{block}: a text block that follows no command; '<!-- not output: WHY -->' where it is none")
            last.output = block.code
        last = block
    return blocks


def page_it_starts_from(text):
    found = re.search(r"^<!-- starts from: (\S+) -->$", text, re.MULTILINE)
    return found and found[1]


def same_line(said, printed):
    """True if a line of a page is what was printed: `…` stands for anything, times and memory are free, numbers nearly equal."""
    pattern, numbers = "", []
    for part in re.split(f"(…|{VARIES.pattern}|{NUMBER.pattern})", said.rstrip()):
        if part == "…":
            pattern += ".*?"
        elif part and re.fullmatch(NUMBER, part):
            pattern += r"(-?\d+(?:\.\d+)?(?:e-?\d+)?)"
            numbers.append(part)
        else:
            pattern += re.sub(r"(\\ )+", lambda _: " +", re.escape(part))
    found = re.fullmatch(pattern, printed.rstrip())
    if not found:
        return False
    free = {match.start() for match in VARIES.finditer(printed)}
    return all(found.start(k + 1) in free or abs(float(a) - float(b)) <= TOLERANCE * max(abs(float(a)), abs(float(b)))
               for k, (a, b) in enumerate(zip(numbers, found.groups())))


def missing_line(said, printed):
    """The first line that a page says and that was not printed in its place; None if all were. A line `…` stands for any number of lines."""
    lines, place, anywhere = printed.splitlines(), 0, False
    for line in said.splitlines():
        if line.strip() == "…":
            anywhere = True
            continue
        while anywhere and place < len(lines) and not same_line(line, lines[place]):
            place += 1
        if place == len(lines) or not same_line(line, lines[place]):
            return line
        place, anywhere = place + 1, False
    return None if anywhere or place == len(lines) else f"(nothing more), where it printed: {lines[place]}"
