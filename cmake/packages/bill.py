#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes the bill of materials of Debian packages, SPDX 2.3: they, what they depend on, what they were built with.

What they depend on must be installed here, which it is where they were built: its version and copyright file are read.
"""
import argparse
import datetime
import hashlib
import json
import os
import re
import subprocess
import sys
import uuid
from pathlib import Path
from urllib.parse import quote

sys.path.insert(0, str(Path(__file__).resolve().parent))
sys.dont_write_bytecode = True
import debian  # noqa: E402

AUTHORS = "Organization: The Palpate authors"
ROOT = Path(__file__).resolve().parents[2]


def identifier(name):
    return "SPDXRef-" + name.replace("+", "plus").replace("_", "-")


def relation(one, kind, other):
    return {"spdxElementId": identifier(one), "relationshipType": kind, "relatedSpdxElement": identifier(other)}


def utc(second):
    return datetime.datetime.fromtimestamp(second, datetime.timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ")


def described(control, licence, supplier, **more):
    """A package as SPDX has it, of its control fields."""
    name, version = control["Package"], control["Version"]
    return {"name": name, "SPDXID": identifier(name), "versionInfo": version, "supplier": supplier,
            "downloadLocation": "NOASSERTION", "filesAnalyzed": False, "licenseConcluded": "NOASSERTION",
            "licenseDeclared": licence, "copyrightText": "NOASSERTION"} | more


def of_debian(control, licences):
    name = control["Package"]
    source = control.get("Source", name).partition(" ")[0]
    file = Path(f"/usr/share/doc/{name}/copyright")
    licence = licences.of(source, file.read_text(errors="replace")) if file.exists() else "NOASSERTION"
    purl = f"pkg:deb/debian/{quote(name)}@{quote(control['Version'])}?arch={control['Architecture']}"
    return described(control, licence, "Organization: Debian", externalRefs=[
        {"referenceCategory": "PACKAGE-MANAGER", "referenceType": "purl", "referenceLocator": purl}])


def of_ours(archive, control, licences):
    text = debian.in_package(archive, f"usr/share/doc/{control['Package']}/copyright")
    digest = hashlib.sha256(archive.read_bytes()).hexdigest()
    return described(control, licences.of("palpate", text), AUTHORS, packageFileName=archive.name,
                     checksums=[{"algorithm": "SHA256", "checksumValue": digest}])


def build_packages():
    """Libraries that packages.txt lists for the programs; many are headers alone and become part of them."""
    listed = (ROOT / "packages.txt").read_text().partition("\n# tests")[0]
    return re.findall(r"^(\S+-dev)\b", listed, re.MULTILINE)


def named_by(control, known):
    """What a package depends on, each the first alternative that is known, under its own name."""
    for name, others in debian.relations(f"{control.get('Depends', '')},{control.get('Pre-Depends', '')}"):
        found = next((each for each in (name, *others) if each in known), None)
        if found is None:
            sys.exit(f"bill.py: {control['Package']} depends on {name}, which is not installed here; install it")
        yield known[found]["Package"]


def dependencies(start, known):
    """{name: [names that it depends on]} of packages and all that they lead to."""
    found, waiting = {}, list(start)
    while waiting:
        name = waiting.pop()
        if name not in found:
            found[name] = sorted(set(named_by(known[name], known)) - {name})
            waiting += found[name]
    return found


def bill(archives):
    licences = debian.Licences()
    ours = {}
    for archive in archives:
        told = subprocess.run(["dpkg-deb", "-f", archive], check=True, capture_output=True, text=True).stdout
        control = debian.stanzas(told)[0]
        ours[control["Package"]] = (archive, control)
    known = debian.installed() | {name: control for name, (_, control) in ours.items()}
    needed = dependencies(ours, known)
    built_with = [name for name in build_packages() if name in known]
    version = next(iter(ours.values()))[1]["Version"]
    packages = [described({"Package": "palpate", "Version": version}, "Apache-2.0 AND GPL-3.0-or-later", AUTHORS)]
    packages += [of_ours(*ours[name], licences) if name in ours else of_debian(known[name], licences)
                 for name in sorted({*needed, *built_with})]
    relations = [relation("DOCUMENT", "DESCRIBES", name) for name in sorted(ours)]
    relations += [relation(name, "GENERATED_FROM", "palpate") for name in sorted(ours)]
    relations += [relation(name, "BUILD_DEPENDENCY_OF", "palpate") for name in built_with]
    relations += [relation(name, "DEPENDS_ON", other) for name in sorted(needed) for other in needed[name]]
    second = int(os.environ.get("SOURCE_DATE_EPOCH", max(archive.stat().st_mtime for archive in archives)))
    digest = hashlib.sha256(json.dumps(packages).encode()).hexdigest()
    return {"spdxVersion": "SPDX-2.3", "dataLicense": "CC0-1.0", "SPDXID": identifier("DOCUMENT"),
            "name": f"palpate-{version}",
            "documentNamespace": f"urn:uuid:{uuid.uuid5(uuid.NAMESPACE_OID, digest)}",
            "creationInfo": {"created": utc(second), "creators": [AUTHORS, f"Tool: palpate-bill-{version}"]},
            "packages": packages, "relationships": relations,
            "hasExtractedLicensingInfos": [{"licenseId": name, "name": name, "extractedText": text.strip()}
                                           for name, text in sorted(licences.texts.items())]}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--output", type=Path, required=True, help="folder for palpate_<version>.spdx.json")
    parser.add_argument("archives", nargs="+", type=Path)
    arguments = parser.parse_args()
    made = bill(arguments.archives)
    path = arguments.output / f"{made['name'].replace('-', '_', 1)}.spdx.json"
    path.write_text(json.dumps(made, indent=1, ensure_ascii=False) + "\n")
    print(f"{path}: {len(made['packages'])} packages")


if __name__ == "__main__":
    main()
