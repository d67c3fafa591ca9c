#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Lists every text that the window shows in palpate.pot, from which translations are made.

    runtime/texts/extract.py [FILE]      palpate.pot beside this if not given

A new language: `msginit -i palpate.pot -l fr -o fr.po`, translate it, add it to palpate_languages in CMakeLists.txt. After
texts changed: this, then `msgmerge -U de.po palpate.pot`.
"""
import json
import re
import subprocess
import sys
import tomllib
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
# Metrics have their titles from their names, as title_of() makes them.
METRICS = ROOT / "runtime/training/metrics.hpp"


def metric_titles():
    names = re.findall(r'Field\(\s*"(\w+)"', METRICS.read_text())
    return "".join(f'shown_text("{name.replace("_", " ").capitalize()}");\n' for name in names)


def of_the_demo():
    """Titles and instructions of the exercises that come with the demo's cases."""
    files = sorted((ROOT / "pipelines/exercises").glob("*.toml"))
    rows = [row for file in files for row in tomllib.loads(file.read_text())["exercise"]]
    return "".join(f"shown_text({json.dumps(row[key])});\n" for row in rows for key in ("title", "instruction"))


def extracted():
    """The template's text."""
    sources = sorted(path.relative_to(ROOT) for hall in ("formats", "runtime") for path in (ROOT / hall).rglob("*.[ch]pp"))
    call = ["xgettext", "--language=C++", "--from-code=UTF-8", "--keyword", "--keyword=translated", "--keyword=shown_text", "--add-location=file",
            "--sort-by-file", "--no-wrap", "--package-name=Palpate", "--output=-"]
    run = subprocess.run([*call, *map(str, sources), "-"], cwd=ROOT, input=metric_titles() + of_the_demo(), capture_output=True, text=True, check=True)
    texts = re.sub(r"\A(#.*\n)+", "# SPDX-License-Identifier: Apache-2.0\n", run.stdout)  # xgettext's form to fill in
    return re.sub(r'^"(POT-Creation-Date|PO-Revision-Date|Last-Translator|Language-Team|Report-Msgid-Bugs-To): .*\n', "", texts, flags=re.MULTILINE)


if __name__ == "__main__":
    Path(sys.argv[1] if len(sys.argv) > 1 else HERE / "palpate.pot").write_text(extracted())
