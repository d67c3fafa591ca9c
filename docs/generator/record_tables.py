#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Fills what Markdown pages say of records from the code's own tables, or says which page is stale.

record_tables.py PROGRAM [--check]

PROGRAM is record_tables, built from formats/records. Between `<!-- haptics keys: generated -->` and `<!-- end -->`
stands the table `haptics` as keys of a case file; `attributes` and `columns` are of assets and recordings,
`definitions` of what is measured.
"""
import argparse
import json
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
MARKED = re.compile(r"(<!-- (\w+) (keys|attributes|columns|definitions): generated -->\n).*?(<!-- end -->)", re.DOTALL)


def cell(text):
    return str(text).replace("|", "\\|")


def number(value):
    return f"{value:g}" if isinstance(value, (int, float)) else ", ".join(f"{v:g}" for v in value)


def meaning_of(row):
    sentence = row["meaning"]
    if row["unit"]:
        sentence = f"{row['unit']}; {sentence}"
    if "absent" in row:
        sentence += f". A file that lacks it means {number(row['absent'])}"
    return sentence


def keys(rows):
    yield "| key | unit | default | | what |"
    yield "|---|---|--:|---|---|"
    for row in rows:
        default = row["default"] if row["written_factor"] == 1 else row["default"] * row["written_factor"]
        yield f"| `{row['key']}` | {row['written_unit']} | {number(default)} | {row['written_range']} | {cell(row['meaning'])} |"


def attributes(rows):
    yield "| attribute | type | what | range |"
    yield "|---|---|---|---|"
    for row in rows:
        yield f"| `{row['name']}` | {row['type']} | {cell(meaning_of(row))} | {row['range'] if row['range'] != 'a finite number' else ''} |"


def columns(rows):
    yield "| dataset | type | what |"
    yield "|---|---|---|"
    for row in rows:
        yield f"| `{row['name']}` | {row['type']} | {cell(meaning_of(row))} |"


def definitions(rows):
    yield "| metric | unit | what |"
    yield "|---|---|---|"
    for row in rows:
        yield f"| `{row['key']}` | {row['unit']} | {cell(row['meaning'])} |"


FORMS = {"keys": keys, "attributes": attributes, "columns": columns, "definitions": definitions}


def filled(text, tables):
    def fill(match):
        start, name, form, end = match.groups()
        return start + "".join(line + "\n" for line in FORMS[form](tables[name])) + end
    return MARKED.sub(fill, text)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program")
    parser.add_argument("--check", action="store_true")
    arguments = parser.parse_args()
    tables = json.loads(subprocess.run([arguments.program], capture_output=True, text=True, check=True).stdout)
    pages = [path for room in ("docs", "formats") for path in sorted((ROOT / room).rglob("*.md"))]
    tables_found = stale = 0
    for page in pages:
        text = page.read_text()
        new = filled(text, tables)
        tables_found += len(MARKED.findall(text))
        if new == text:
            continue
        stale += 1
        print(f"{page.relative_to(ROOT)}: {'stale' if arguments.check else 'written anew'}")
        if not arguments.check:
            page.write_text(new)
    print(f"{tables_found} tables in {len(pages)} pages, {stale} pages "
          + ("stale; run docs/generator/record_tables.py on build/<preset>/tests/record_tables" if stale and arguments.check else "changed"))
    return 1 if arguments.check and stale or not tables_found else 0


if __name__ == "__main__":
    sys.exit(main())
