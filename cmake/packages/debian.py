# SPDX-License-Identifier: Apache-2.0
"""Debian's control and copyright files, and the licences in them by SPDX's names."""
import re
import subprocess
from pathlib import Path

# Debian's short names, which it writes in lower and upper case, and SPDX's.
SAME = ("MIT", "BSD-2-Clause", "BSD-3-Clause", "ISC", "Zlib", "Apache-2.0", "BSL-1.0", "CC0-1.0", "curl", "FTL",
        "MPL-1.1", "MPL-2.0", "X11", "FSFAP", "FSFUL", "FSFULLR")
SPDX = {name.lower(): name for name in SAME} | {"expat": "MIT", "artistic": "Artistic-1.0"}
GNU = re.compile(r"(a?gpl|lgpl|gfdl)-(\d)(\.\d)?(\+?)")


def stanzas(text):
    """Fields of each paragraph of a control file."""
    fields = re.compile(r"^([A-Za-z][\w-]*):[ \t]*(.*(?:\n[ \t].*)*)", re.MULTILINE)
    return [dict(fields.findall(part)) for part in re.split(r"\n\s*\n", text) if part.strip()]


def installed():
    """{name: its stanza} of this machine's packages, by what they provide as well."""
    every = stanzas(Path("/var/lib/dpkg/status").read_text())
    status = [each for each in every if each["Status"].endswith(" installed")]
    provided = {name: each for each in status for name, _ in relations(each.get("Provides", ""))}
    return provided | {each["Package"]: each for each in status}


def relations(field):
    """[(name, alternatives)] of a field such as Depends; the versions are left out."""
    clauses = (re.findall(r"(?:^|\|)\s*([\w.+-]+)", clause) for clause in field.split(","))
    return [(names[0], names[1:]) for names in clauses if names]


def in_package(archive, path):
    """Text of a file in a .deb."""
    files = subprocess.run(["dpkg-deb", "--fsys-tarfile", archive], check=True, capture_output=True).stdout
    return subprocess.run(["tar", "-xO", f"./{path}"], check=True, capture_output=True, input=files).stdout.decode()


def by_spdx(name):
    """SPDX's name of a licence that has one."""
    if gnu := GNU.fullmatch(name.lower()):
        return f"{gnu[1].upper()}-{gnu[2]}{gnu[3] or '.0'}-{'or-later' if gnu[4] else 'only'}"
    return SPDX.get(name.lower())


class Licences:
    """Expressions for copyright files; texts of what SPDX has no name for are kept in `texts` by their reference."""

    def __init__(self):
        self.texts = {}

    def reference(self, source, name, text):
        made = f"LicenseRef-{source}-{re.sub('[^A-Za-z0-9.]+', '-', name)[:60]}".strip("-").replace("+", "plus")
        while self.texts.setdefault(made, text) != text:  # another text by this name
            made += ".1"
        return made

    def of(self, source, copyright_text):
        """Expression of all licences that a copyright file names; of one in free form a reference to itself."""
        parts = stanzas(copyright_text)
        if not parts or "Format" not in parts[0]:
            return self.reference(source, "copyright", copyright_text)
        texts = {}
        for part in parts:
            name, _, text = part.get("License", "").partition("\n")
            if text.strip():
                texts[name.strip()] = text

        def atom(name):
            return by_spdx(name) or self.reference(source, name, texts.get(name, copyright_text))

        def terms(name):
            """Of which all hold, of a short name that may have 'and' and 'or' in it."""
            choices = [name] if "," in name else name.split(" or ")
            every = [[atom(word.strip()) for word in choice.split(" and ")] for choice in choices]
            return every[0] if len(every) == 1 else [f"({' OR '.join(sorted({' AND '.join(each) for each in every}))})"]

        names = {part["License"].partition("\n")[0].strip() for part in parts if "Files" in part and "License" in part}
        return " AND ".join(sorted({term for name in names if name for term in terms(name)})) or "NOASSERTION"
