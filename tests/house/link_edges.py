#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Fails if a target links what the house forbids, directly or through others, or a runtime executable loads it.

Reads <build folder>/link_edges.txt (lines "target: library;library") and, where they exist, the executables in
<build folder>/bin.
"""
import re
import subprocess
import sys
from pathlib import Path

# Small libraries that bind a room to nothing.
EVERYWHERE = {"dl", "eigen", "fmt", "threads"}
# What tests stand on, not part of the house.
TEST_SUPPORT = {"palpate_cgal_peer", "palpate_house", "palpate_phantoms", "palpate_sample_case"}
# What each room may link directly: rooms of ours, and families of other libraries.
ROOMS = {
    "drawing": set(),
    "records": set(),
    "model": {"records"},
    "elasticity": {"model"},
    "hyperelasticity": {"model", "elasticity"},
    "provenance": {"json"},
    "asset": {"model", "hdf5", "openssl", "threads"},
    "stl_file": {"model"},
    "toml_file": {"model", "toml"},
    "recording": {"model", "asset"},
    "vtk_blocks": {"vtk"},
    "imaging": {"model", "vtk_blocks", "itk", "hdf5", "dcmtk", "vtk", "json", "zlib"},  # HDF5 is one of ITK's own
    "archive": {"model", "asset", "imaging", "dcmtk", "hdf5", "zlib"},
    "meshing": {"model", "vtk_blocks", "cgal", "vtk", "json"},
    "obb": {"model"},
    "fem": {"model", "elasticity", "hyperelasticity", "linear_algebra"},
    "linear_algebra": {"cholmod", "metis", "lapack"},
    "report": {"model", "asset", "drawing", "provenance", "meshing", "vtk", "json"},
    "cli": {"model", "drawing", "cli11", "spdlog", "json", "toml"},
    "requests": {"model", "cli", "json"},
    "stage_images": {"requests", "imaging"},
    "stage_shapes": {"requests", "imaging", "meshing"},
    "stage_bodies": {"requests", "fem", "meshing"},
    "stage_cases": {"requests", "asset", "fem", "hyperelasticity", "imaging", "meshing", "obb"},
    "inspection": {"stage_images", "stage_shapes", "stage_bodies", "asset", "draft"},
    "tissue": {"model"},
    "draft": {"model", "imaging", "tissue", "toml_file"},
    "case_builder": {"model", "asset", "cli", "imaging", "requests", "tissue", "toml_file", "json"},
    "cohort": {"model", "case_builder", "cli", "imaging", "report", "toml_file", "json"},
    "seeds": {"model", "imaging", "vtk"},
    "hd_conformance": {"model", "devices", "json"},
    "realtime": {"records"},
    "collision": {"model"},
    "haptics": {"model", "records", "hyperelasticity", "collision", "realtime"},
    "devices": {"model", "realtime"},
    "doctor": {"model", "realtime", "haptics", "devices", "json"},
    "openigtlink": {"model", "realtime", "haptics", "devices", "igtl"},
    "visual": {"model", "elasticity", "collision", "realtime", "texts", "vtk"},
    "sound": {"model", "openal"},
    "texts": set(),
    "session": {"model", "asset", "elasticity", "recording", "drawing", "json", "realtime", "collision", "haptics", "devices", "openigtlink"},
    "training": {"model", "asset", "session", "toml_file", "json"},
}
ROOMS["experiments"] = {"asset", "drawing", "cli", "session", "stl_file", "fem", "meshing", "obb", "cgal_peer", "fcl", "bullet"}  # measures both sides
COMMANDS = {"model", "archive", "asset", "elasticity", "imaging", "meshing", "obb", "fem", "report", "cli", "case_builder", "cohort", "draft", "inspection", "requests", "stage_images", "stage_shapes",
            "stage_bodies", "stage_cases", "seeds", "tissue", "toml_file", "json"}
APPS = {"model", "asset", "recording", "stl_file", "cli", "realtime", "collision", "haptics", "devices", "openigtlink", "session", "json"}
EXECUTABLES = {
    "palpate": {"cli", "model"},
    "palpate-touch": APPS,
    "palpate-doctor": APPS | {"doctor"},
    "palpate-train": APPS | {"provenance", "sound", "texts", "training", "visual"},
    "palpate-bench": {"experiments"},
}
HEAVY = {"itk", "cgal", "cholmod", "metis", "vtk"}
LEAN = {"palpate_drawing", "palpate_provenance", "palpate_records", "palpate_model", "palpate_elasticity", "palpate_hyperelasticity", "palpate_asset", "palpate_recording", "palpate_cli", "palpate_realtime", "palpate_collision",
        "palpate_haptics", "palpate_devices", "palpate_openigtlink", "palpate_session", "palpate_stl_file", "palpate_toml_file", "palpate_training", "palpate_doctor", "palpate-touch",
        "palpate-doctor"}
# These two draw, so VTK is theirs; nothing else that is heavy.
DRAWING = {"palpate_visual", "palpate-train"}
FAMILIES = {
    "dl": r"^dl$", "eigen": r"Eigen3::", "hdf5": r"hdf5|HDF5|/libhdf5|libsz|libz\.|libdl|libm\.|^dl$|^m$", "openssl": r"OpenSSL::",
    "dcmtk": r"/libdcm|/libof(?:log|std)", "igtl": r"OpenIGTLink::",
    "itk": r"ITK|itk|gdcm", "cgal": r"CGAL", "vtk": r"VTK::|X11::", "cholmod": r"cholmod", "metis": r"libmetis",
    "lapack": r"lapacke|openblas", "cli11": r"CLI11::", "spdlog": r"spdlog", "fmt": r"fmt::", "json": r"nlohmann_json",
    "bullet": r"PALPATE_BULLET", "openal": r"OpenAL::", "toml": r"tomlplusplus", "threads": r"Threads::", "zlib": r"ZLIB::", "house": r"palpate_house",
}
FORBIDDEN_SONAMES = {"palpate-touch": r"libITK|libitk|libCGAL|libcholmod|libmetis|libvtk",
                     "palpate-doctor": r"libITK|libitk|libCGAL|libcholmod|libmetis|libvtk",
                     "palpate-train": r"libITK|libitk|libCGAL|libcholmod|libmetis"}


def family(library):
    """'model' for Palpate::model or palpate_model, 'itk' for ITKCommon, ..."""
    if match := re.fullmatch(r"(?:Palpate::|palpate_)(\w+)", library):
        return match.group(1)
    for name, pattern in FAMILIES.items():
        if re.search(pattern, library):
            return name
    return library


def read_edges(path):
    edges = {}
    for line in path.read_text().splitlines():
        target, _, libraries = line.partition(": ")
        cleaned = re.sub(r"\$<(?:BUILD_INTERFACE|LINK_ONLY|INSTALL_INTERFACE):([^>]*)>", r"\1", libraries)
        names = [name for name in cleaned.split(";") if name and "NOTFOUND" not in name]
        edges[target] = {family(name) for name in names} - {"house", "optimized", "debug"}
    return edges


def allowed_for(target):
    if target.startswith("palpate_"):
        return ROOMS.get(target[len("palpate_"):])
    if target in EXECUTABLES:
        return EXECUTABLES[target]
    return COMMANDS if target.startswith("palpate-") else None


def closure(start, edges):
    seen, stack = set(), [start]
    while stack:
        for name in edges.get(stack.pop(), ()):
            if name not in seen:
                seen.add(name)
                stack.append("palpate_" + name)
    return seen


def main(build):
    edges = read_edges(build / "link_edges.txt")
    errors = []
    for target, linked in edges.items():
        if target in TEST_SUPPORT or not target.startswith("palpate") or target.startswith("palpate_precompiled_"):
            continue  # tests and benchmarks may link both sides; precompiled headers are linked by nothing
        allowed = allowed_for(target)
        if allowed is None:
            errors.append(f"{target}: no rule; add the room to link_edges.py")
            continue
        errors += [f"{target} links {name}, which its room may not" for name in sorted(linked - allowed - EVERYWHERE)]
    for target in sorted((LEAN | DRAWING) & edges.keys()):
        heavy = closure(target, edges) & (HEAVY - {"vtk"} if target in DRAWING else HEAVY)
        errors += [f"{target} reaches {name} through what it links" for name in sorted(heavy)]
    for name, forbidden in FORBIDDEN_SONAMES.items():
        program = build / "bin" / name
        if program.exists():
            loaded = subprocess.run(["ldd", program], capture_output=True, text=True, check=True).stdout
            errors += [f"{name} loads {line.split()[0]}" for line in loaded.splitlines() if re.search(forbidden, line)]
    for error in errors:
        print(error)
    print(f"{len(edges)} targets read, {len(errors)} forbidden edges")
    return 1 if errors else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))
