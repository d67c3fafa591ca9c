# SPDX-License-Identifier: Apache-2.0
"""Manual pages, of the programs' own help: man(7) source that groff and mandoc take without a warning."""
import datetime
import os
import re
import subprocess

from docs.generator import commands


def plain(text):
    """Text that roff prints as it is."""
    text = text.replace("\\", "\\e").replace("-", "\\-")
    return re.sub(r"^(?=[.'])", r"\\&", text, flags=re.MULTILINE)


def bold(text):
    return f"\\fB{plain(text)}\\fR"


def slanted(text):
    return f"\\fI{plain(text)}\\fR"


def as_it_is(lines):
    return [".EX", *(plain(line) for line in lines), ".EE"]


def paragraphs(notes):
    """Notes as paragraphs; those with indented lines, which are lists, keep their lines."""
    made = []
    for paragraph in filter(None, re.split(r"\n\s*\n", notes.strip())):
        lines = paragraph.splitlines()
        listed = any(line.startswith(" ") for line in lines)
        made += ([".PP"] if made else []) + (as_it_is(lines) if listed else [plain(line.strip()) for line in lines])
    return made


def options(listed):
    made = []
    for option in listed:
        takes = f" {slanted(option.takes)}" if option.takes else ""
        default = option.default and (" (required)" if option.default == "required" else f" [{plain(option.default)}]")
        made += [".TP", ", ".join(map(bold, option.names)) + takes + default, plain(commands.meaning(option))]
    return made


def head(program, programs):
    """The title line, with the program's version and its own date."""
    told = subprocess.run([programs / program, "--version"], capture_output=True, text=True, check=True).stdout
    second = int(os.environ.get("SOURCE_DATE_EPOCH", (programs / program).stat().st_mtime))
    day = datetime.datetime.fromtimestamp(second, datetime.timezone.utc).date()
    return f'.TH {plain(program.upper())} 1 {day} "{told.strip().title()}" Palpate'


def sections(*parts):
    return "\n".join(line for title, lines in parts if lines for line in (f".SH {title}", *lines)) + "\n"


def page_of_command(programs, program):
    name = program.removeprefix("palpate-")
    told = commands.help_of(programs, name)
    usage = told.usage.removeprefix(f"palpate {name}").strip()
    return head(program, programs) + "\n" + sections(
        ("NAME", [f"{plain(program)} \\- {plain(told.summary.rstrip('.'))}"]),
        ("SYNOPSIS", [f"{bold(f'palpate {name}')} {plain(usage)}"]),
        ("DESCRIPTION", paragraphs(told.notes)),
        ("OPTIONS", options(sum(told.groups.values(), []))),
        ("EXAMPLES", as_it_is(told.examples)),
        ("SEE ALSO", [r"\fBpalpate\fR(1)"]))


def page_of_palpate(root, programs):
    """Of the program that runs the commands: all that are built, in whichever package they come."""
    names = [name for name in commands.command_names(root) if (programs / f"palpate-{name}").exists()]
    listed = [line for name in names for line in (
        ".TP", f"{bold(f'palpate {name}')}", plain(commands.help_of(programs, name).summary.rstrip(".") + "."))]
    of_all = commands.help_of(programs, names[0]).notes.rpartition("\n\n")[2]  # on units and exit codes
    return head("palpate", programs) + "\n" + sections(
        ("NAME", [r"palpate \- turns a patient's CT or MRI into an organ that a hand can feel"]),
        ("SYNOPSIS", [r"\fBpalpate\fR \fIcommand\fR [\fIoptions\fR]"]),
        ("DESCRIPTION", ["Runs a command. Each is a program with a manual page of its own; those that are not",
                         r"installed come with the packages palpate\-tools and palpate\-trainer.", ".PP", plain(of_all)]),
        ("COMMANDS", listed),
        ("SEE ALSO", [", ".join(rf"\fBpalpate\-{name}\fR(1)" for name in names)]))


def page(root, programs, program):
    """Page of a program in the folder `programs`. Throws commands.NotBuilt."""
    return page_of_palpate(root, programs) if program == "palpate" else page_of_command(programs, program)
