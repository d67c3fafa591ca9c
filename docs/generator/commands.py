# SPDX-License-Identifier: Apache-2.0
"""What palpate's programs say about themselves with --help, and docs/commands.md made of it."""
import functools
import os
import re
import subprocess
import textwrap
from collections import namedtuple

COLUMN = 30  # where the help's descriptions begin
WIDTH = 110  # of notes
EXAMPLES = "<!-- examples: tests/commands/docs/test_examples.py -->"  # where they run
KINDS = {"TEXT": "text", "FLOAT": "number", "INT": "integer", "UINT": "integer from 0 on",
         "FLOAT:POSITIVE": "number above 0", "FLOAT:NONNEGATIVE": "number from 0 on", "INT:POSITIVE": "integer above 0"}
Option = namedtuple("Option", "names takes default needs meaning")
# Help of one command; `groups` by title: "Positionals", "Options", "Every command"; `notes` is what follows them.
Help = namedtuple("Help", "summary usage groups examples notes")


class NotBuilt(Exception):
    """A program that the tree describes is not in the folder of programs."""


def command_names(root):
    """Commands that the tree builds, in ascending order, whether they are built or not."""
    lists = [path for hall in ("tools", "runtime") for path in (root / hall).rglob("CMakeLists.txt")]
    return sorted({name for path in lists for name in re.findall(r"palpate_executable\(\s*palpate-([a-z]+)", path.read_text())})


def read_option(left, meaning):
    """From "-o,--output TEXT=a REQUIRED Needs: --b" and what stands right of it."""
    names, _, rest = left.partition(" ")
    found = re.match(r"(?P<takes>.*?)(?P<required>\s*\bREQUIRED)?\s*"
                     r"(?P<needs>(?:\b(?:Needs|Excludes):.*)?)$", rest)
    takes, _, default = found["takes"].strip().partition("=")
    many = default.endswith(" ...") or takes.endswith(" ...")
    takes, default = takes.removesuffix(" ..."), default.removesuffix(" ...")
    kind = takes.partition(":")[2] if re.match(r"[A-Z]+:[A-Z]+ in ", takes) else takes
    kind = KINDS.get(kind) or re.sub(r"^[A-Z]+", lambda word: KINDS.get(word[0], word[0]), kind)
    return Option(names.split(","), kind + (", several" if many else ""), "required" if found["required"] else default,
                  found["needs"], meaning)


def split_help(text):
    """[(title, lines)] of a help text; the text before the first title has none."""
    parts = [("", [])]
    for line in text.splitlines():
        title = re.fullmatch(r"(Positionals|Options|Every command|Examples):", line)
        parts.append((title[1], [])) if title else parts[-1][1].append(line)
    return parts


def read_options(lines):
    """Options from lines "  NAMES TYPE   meaning"; the meaning of those with long names is on the next line."""
    options = []
    for line, following in zip(lines, [*lines[1:], ""]):
        if re.match(r"  \S", line):
            alone = len(line) > COLUMN and (line[COLUMN - 1] != " " or following.startswith(" " * COLUMN))
            end = len(line) if alone else COLUMN
            options.append(read_option(line[:end].strip(), line[end:].strip()))
        elif line.strip() and options:
            options[-1] = options[-1]._replace(meaning=f"{options[-1].meaning} {line.strip()}".strip())
    return options


def read_help(text):
    groups, summary, usage, examples, notes = {}, "", "", [], []
    for title, lines in split_help(text):
        if title == "Examples":
            end = next((k for k, line in enumerate(lines) if not line.strip()), len(lines))
            examples, notes = [line.strip() for line in lines[:end]], lines[end:]
        elif title:
            groups[title] = read_options(lines)
        else:
            usage = next(line for line in lines if line.startswith("Usage:"))
            summary = " ".join(lines[:lines.index(usage)]).strip()
    return Help(summary, usage.removeprefix("Usage: "), groups, examples, "\n".join(notes).strip())


@functools.cache
def help_of(programs, name):
    """Help of a command in the folder `programs`. Throws NotBuilt."""
    path = programs / f"palpate-{name}"
    if not path.exists():
        raise NotBuilt(f"palpate-{name} is not in {programs}")
    said = subprocess.run([path, "--help"], capture_output=True, text=True, check=True,
                          env=os.environ | {"LC_ALL": "C.UTF-8"})
    return read_help(said.stdout)


def option_names(text):
    """Every name by which a Help's options are called."""
    return {name for options in text.groups.values() for option in options for name in option.names}


def cell(text):
    """As a cell of a Markdown table."""
    return re.sub(r"(?<![`\w])('palpate [^']+'|--[a-z][a-z0-9-]*)", lambda code: f"`{code[0].strip(chr(39))}`", text.replace("|", "\\|").replace("<", "&lt;")) or "–"


def meaning(option):
    """What an option does, and with which others."""
    needs = option.needs.replace("Excludes:", "not with").replace("Needs:", "only with")
    needs = re.sub(r"(?<=\w) (?=--)", ", ", re.sub(r"\s+(not with|only with)", r"; \1", needs)).replace("with, ", "with ")
    return "; ".join(part for part in (option.meaning, needs) if part)


def option_table(options):
    lines = ["| option | takes | default | meaning |", "|---|---|---|---|"]
    for option in options:
        default = option.default if option.default == "required" else f"`{option.default}`" if option.default else "–"
        lines.append(f"| {', '.join(f'`{name}`' for name in option.names)} | {cell(option.takes)} | {default} | {cell(meaning(option))} |")
    return lines


def common_options(helps):
    """What every command has, as they all say it."""
    first = next(iter(helps.values()))
    return [option for options in first.groups.values() for option in options
            if all(option in group for text in helps.values() for group in [sum(text.groups.values(), [])])]


def wrapped(notes):
    """Notes with long lines broken; lists, which are indented, stay as they are."""
    return [part for line in notes.strip().splitlines()
            for part in ([line] if line.startswith(" ") else textwrap.wrap(line, WIDTH, break_on_hyphens=False) or [""])]


def section(name, text, common):
    own = [option for options in text.groups.values() for option in options if option not in common]
    lines = [f"## palpate {name}", "", text.summary.rstrip(".") + ".", "", *option_table(own), ""]
    notes, _, last = text.notes.rpartition("\n\n")  # the last paragraph, on exit codes, is the page's beginning
    if not last.startswith("Positions are LPS mm."):
        notes = text.notes
    lines += [EXAMPLES, "```sh", *text.examples, "```", ""]
    return lines + (["<!-- not output: notes of --help -->", "```text", *wrapped(notes), "```", ""] if notes.strip() else [])


def reference(root, programs):
    """docs/commands.md's generated part: what all commands have in common, then each by itself."""
    helps = {name: help_of(programs, name) for name in command_names(root)}
    common = common_options(helps)
    lines = [", ".join(f"[`{name}`](#palpate-{name})" for name in helps), "", "## Every command", "", *option_table(common), ""]
    for name, text in helps.items():
        lines += section(name, text, common)
    return "\n".join(lines).strip()
