#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Fails if palpate.pot does not list what the window says, or a translation lacks a text or has other fields than it."""
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
TEXTS = ROOT / "runtime/texts"
sys.path.insert(0, str(TEXTS))
import extract  # noqa: E402


def entries(po):
    """Translations by their English."""
    def part(block, key):
        match = re.search(rf"^{key} ((?:\".*\"\n?)+)", block, re.MULTILINE)
        return "".join(re.findall(r'"(.*)"', match.group(1))) if match else ""
    pairs = {part(block, "msgid"): part(block, "msgstr") for block in po.split("\n\n") if re.search("^msgid", block, re.MULTILINE)}
    return {english: text for english, text in pairs.items() if english}


def main():
    errors = []
    said = set(entries(extract.extracted()))
    if said != set(entries((TEXTS / "palpate.pot").read_text())):
        errors.append("palpate.pot is not what the code says: run runtime/texts/extract.py")
    catalogues = sorted(TEXTS.glob("*.po"))
    for catalogue in catalogues:
        translations = entries(catalogue.read_text())
        errors += [f"{catalogue.name}: '{english}' has no translation" for english in sorted(said) if not translations.get(english)]
        errors += [f"{catalogue.name}: '{english}' is said no more" for english in sorted(set(translations) - said)]
        fields = lambda text: sorted(re.findall(r"\{[^}]*\}", text))
        errors += [f"{catalogue.name}: '{english}' and '{text}' have other fields" for english, text in translations.items()
                   if text and fields(text) != fields(english)]
    if not said or not catalogues:
        errors.append("no texts or no translation found")
    print("\n".join(errors) or f"{len(said)} texts, {len(catalogues)} translations")
    return bool(errors)


if __name__ == "__main__":
    sys.exit(main())
