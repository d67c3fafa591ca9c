#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Fails if a type or function is defined in two files, or a file's own helper hides what its neighbours mean.

names.py <source folder>

Two types of one name in one program break C++'s one-definition rule without a word from the linker. And where a preset
compiles several files of a room together, a helper in one file's unnamed namespace comes before a function of the same
name and number of parameters that a header declares: the next file would silently call the helper.
Reads formats, tools, runtime and, for what hides, tests with Universal Ctags.
"""
import collections
import json
import re
import subprocess
import sys
from pathlib import Path

ROOMS = ("formats", "tools", "runtime")
PROGRAMS = ("tests", "sample_data")  # each test is a program of its own, so only hiding counts there
TYPES = {"class", "struct", "union", "enum"}


def target_folder(path):
    """Whose CMakeLists.txt builds it: files of its subfolders are compiled together too."""
    return next((p for p in path.parents if (p / "CMakeLists.txt").exists()), path.parent)


def tags(root):
    files = [str(p.relative_to(root)) for room in ROOMS + PROGRAMS for p in sorted((root / room).rglob("*.[ch]pp")) if "clashing_names" not in p.relative_to(root).parts]
    lines = subprocess.run(["ctags", "--languages=C++", "--kinds-C++=fpcsgu", "--fields=+nsSKzZ",
                            "--output-format=json", "-L", "-", "-f", "-"], input="\n".join(files), cwd=root, text=True,
                           capture_output=True, check=True).stdout.splitlines()
    return files, [json.loads(line) for line in lines]


def parameters(signature):
    """The parameters' types, roughly: enough to tell overloads apart."""
    inside = re.sub(r"\s*=\s*[^,)]*", "", signature.strip()[1:-1])
    parts, depth, part = [], 0, ""
    for c in inside:
        depth += (c in "<({") - (c in ">)}")
        if c == "," and depth == 0:
            parts.append(part)
            part = ""
        else:
            part += c
    parts.append(part)
    return tuple(re.sub(r"\s*\b\w+\s*$", "", p.strip()) if " " in p.strip() else p.strip() for p in parts if p.strip())


def defined_twice(found):
    places = collections.defaultdict(set)
    for tag in found:
        scope = tag.get("scope", "")
        if tag["path"].startswith(PROGRAMS) or "__anon" in scope or tag["name"].startswith("__anon") or tag["name"] == "main":
            continue
        if tag["kind"] in TYPES:
            places[f"{scope}::{tag['name']}"].add(tag["path"])
        elif tag["kind"] == "function" and tag["path"].endswith(".cpp"):
            places[f"{scope}::{tag['name']}({', '.join(parameters(tag.get('signature', '()')))})"].add(tag["path"])
    return [f"{name} is defined in {' and '.join(sorted(paths))}" for name, paths in sorted(places.items()) if len(paths) > 1]


def hidden(root, files, found):
    declared = collections.defaultdict(set)  # (name, number of parameters) -> headers
    for tag in found:
        scope = tag.get("scope", "")
        if tag["kind"] in ("function", "prototype") and tag["path"].endswith(".hpp") and tag.get("scopeKind") == "namespace":
            declared[tag["name"], len(parameters(tag.get("signature", "()")))].add(tag["path"])
    neighbours = collections.defaultdict(list)  # folder of a target -> its sources and their texts
    for path in files:
        if path.endswith(".cpp"):
            neighbours[target_folder(root / path)].append((path, (root / path).read_text()))
    errors = []
    for tag in found:
        if tag["kind"] != "function" or not re.search(r"__anon\w+$", tag.get("scope", "")):
            continue
        headers = declared.get((tag["name"], len(parameters(tag.get("signature", "()")))))
        if not headers:
            continue
        for path, text in neighbours[target_folder(root / tag["path"])]:
            if path == tag["path"]:
                continue
            if any(f'"{header}"' in text for header in headers) and re.search(rf"(?<![\w.:>]){tag['name']}\(", text):
                errors.append(f"{tag['path']}:{tag['line']}: {tag['name']} would hide the one that {path} means; rename it")
    return errors


def main(root):
    files, found = tags(root)
    errors = defined_twice(found) + hidden(root, files, found)
    for error in errors:
        print(error)
    print(f"{len(files)} files with {len(found)} definitions and declarations read, {len(errors)} clashes")
    return 1 if errors or not found else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))
