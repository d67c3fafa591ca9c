#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes what a Debian package tells of itself below share/: copyright, changelog, manual pages of its commands.

The copyright file sums up the SPDX lines of the folders that the package is compiled from.
"""
import argparse
import email.utils
import gzip
import os
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))
sys.dont_write_bytecode = True
from docs.generator import commands, manual  # noqa: E402

SPDX_LINE = re.compile(rb"SPDX-License-Identifier: (\S+)")
# SPDX's name -> Debian's, and its file of the text.
DEBIAN = {"Apache-2.0": ("Apache-2.0", "Apache-2.0"), "GPL-3.0-or-later": ("GPL-3+", "GPL-3")}
MAINTAINER = "The Palpate authors <maintainers@palpate.invalid>"
AUTHORS = "2026 the Palpate authors"
HEAD = """Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/
Upstream-Name: Palpate
Upstream-Contact: The Palpate authors
"""


def licences_below(path):
    """Licences of the files in a folder."""
    found = set()
    for file in (each for each in path.rglob("*") if each.is_file() and "__pycache__" not in each.parts):
        with file.open("rb") as stream:
            if match := SPDX_LINE.search(stream.readline() + stream.readline()):
                found.add(match[1].decode())
    return found


def patterns(folder):
    """{licence: [patterns]} of a folder: whole where all its files have one licence, else by its folders."""
    licences = licences_below(ROOT / folder)
    if len(licences) == 1:
        return {licences.pop(): [f"{folder}/*"]}
    found = {}
    for part in sorted(each.name for each in (ROOT / folder).iterdir() if each.is_dir()):
        for licence, names in patterns(f"{folder}/{part}").items():
            found.setdefault(licence, []).extend(names)
    return found


def copyright_file(sources):
    by_licence = {}
    for folder in sources:
        for licence, names in patterns(folder).items():
            by_licence.setdefault(licence, []).extend(names)
    text = HEAD
    for licence, names in sorted(by_licence.items()):
        files = "\n ".join(names)
        text += f"\nFiles: {files}\nCopyright: {AUTHORS}\nLicense: {DEBIAN[licence][0]}\n"
    for licence in sorted(by_licence):
        short, file = DEBIAN[licence]
        text += f"\nLicense: {short}\n The whole text is in /usr/share/common-licenses/{file}.\n"
    return text


def changelog(version):
    """CHANGELOG.md as Debian writes one; what is not released yet is the version that is packed."""
    path = ROOT / "CHANGELOG.md"
    date = email.utils.formatdate(int(os.environ.get("SOURCE_DATE_EPOCH", path.stat().st_mtime)))
    text = ""
    for release in re.split(r"^## ", path.read_text(), flags=re.MULTILINE)[1:]:
        title, _, body = release.partition("\n")
        number, suite = (version, "UNRELEASED") if title == "Unreleased" else (title.split()[0], "bookworm")
        marked = re.sub(r"^### (.*)", r"[ \1 ]", body.strip(), flags=re.MULTILINE)
        marked = re.sub(r"^- ", "* ", marked, flags=re.MULTILINE)
        changes = "\n".join(f"  {line}".rstrip() for line in marked.splitlines())
        text += f"palpate ({number}) {suite}; urgency=medium\n\n{changes}\n\n -- {MAINTAINER}  {date}\n\n"
    return text


def write_packed(path, text):
    """The same text gives the same bytes."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(gzip.compress(text.encode(), mtime=0))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("package")
    parser.add_argument("version")
    parser.add_argument("--share", type=Path, required=True, help="folder to write below")
    parser.add_argument("--programs", type=Path, required=True, help="folder of all programs")
    parser.add_argument("--sources", nargs="+", required=True, help="folders that the package is compiled from")
    parser.add_argument("--commands", nargs="*", default=[], help="programs in the package")
    arguments = parser.parse_args()
    documents = arguments.share / "doc" / arguments.package
    write_packed(documents / "changelog.gz", changelog(arguments.version))
    (documents / "copyright").write_text(copyright_file(arguments.sources))
    for program in arguments.commands:
        page = manual.page(ROOT, arguments.programs, program)
        write_packed(arguments.share / f"man/man1/{program}.1.gz", page)


if __name__ == "__main__":
    os.umask(0o022)
    main()
