#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Fails if an object file of the tick imports anything that may allocate, lock, throw, wait or do I/O.

tick_imports.py <build folder>     the objects listed below, by what the linker will see of them
tick_imports.py --objects A.o ...  these objects instead

Every undefined symbol of a listed object must be harmless (HARMLESS) or defined in a listed object, so the list is closed
under calls: what the tick calls is on it. Calls through virtual functions and function pointers leave no symbol; those of
contact methods are on the list by their folder, the allocation trap of tests/runtime sees the others.
Instrumented builds import their sanitizer, so they are not checked.
"""
import subprocess
import sys
from pathlib import Path

# Target folder: object -> why it is the tick's.
TICK = {
    "runtime/collision/CMakeFiles/palpate_collision.dir": {
        "features/surface_features": "which vertex, edge or face is nearest",
        "field/distance_field_queries": "distance by voxels",
        "neighbourhood": "sweeps against the triangles next to the tool",
        "rounded_triangle": "a point against one triangle that is round at its edges",
        "segment_queries": "segments against segments and triangles",
        "surface_access": "triangles and nodes, read by every query",
        "surface_normals": "inside or outside, normals",
        "surface_queries": "nearest point, sweep, triangles near",
        "surroundings": "gathers the triangles around the tool",
        "tree_pairs": "surface against surface",
        "triangle_queries": "point and sphere against one triangle",
    },
    "runtime/haptics/CMakeFiles/palpate_haptics.dir": {
        "contact/contact_lcp": "complementarity",
        "contact/equilibrium/contact_equilibrium": "tools and tissue, brought to rest together",
        "contact/equilibrium/equilibrium_friction": "the same, friction",
        "contact/equilibrium/equilibrium_iterates": "the same, the way there",
        "contact/equilibrium/equilibrium_rows": "the same, what may press",
        "contact/equilibrium/equilibrium_sinking": "the same, how far spheres sink in",
        "contact/equilibrium/equilibrium_turning": "the same, tools that turn",
        "contact/equilibrium/neighbour_contact": "bodies beside each other",
        "contact/deformable_contact": "compliance and displacements of an elastic body",
        "contact/equilibrium/deformed_patch": "the part of a surface that tools are near",
        "contact/equilibrium/deformed_patch_creep": "what is left of earlier forces on it",
        "contact/equilibrium/deformed_patch_large": "and how it leans on a shape of large deformation",
        "contact/large/large_deformation": "shapes taken in, forces told",
        "contact/god_object": "the tool that stays outside",
        "force_limiter": "force and slew limits",
        "haptic_tick": "one tick, from positions to forces",
        "passivity_observer": "no more energy out than in",
        "shell/shell_equilibrium": "a whole tool, brought to rest",
        "shell/shell_watch": "which points of it are inside a body",
        "solid/least_distance": "the motion that keeps a tool's touches",
        "solid/solid_equilibrium": "a tool's triangles, brought to rest",
        "solid/solid_watch": "which of them are close to a body's",
    },
    "runtime/realtime/CMakeFiles/palpate_realtime.dir": {
        "histogram": "what a tick spent",
    },
    "formats/model/CMakeFiles/palpate_model.dir": {
        "compliance": "blocks and products of the compliance",
        "contact/local_indentation": "what a sphere sinks in",
    },
}
# Called through a virtual function, so that no symbol leads here: every object of a contact method but those that set
# it up and the table of them all.
METHODS = "runtime/haptics/methods"
for source in sorted((Path(__file__).resolve().parents[2] / METHODS).glob("*.cpp")):
    if not source.stem.endswith("_setup") and source.stem != "contact_methods":
        TICK["runtime/haptics/CMakeFiles/palpate_haptics.dir"][f"methods/{source.stem}"] = "a contact method's tick"
HARMLESS = {
    "memcpy": "compilers emit it for copies",
    "memmove": "the same",
    "memset": "the same",
    "memcmp": "the same",
    "atan2": "arithmetic",
    "cbrt": "arithmetic",
    "sincos": "arithmetic",
    "__gxx_personality_v0": "named by the unwind table of every noexcept function: an exception would end the program",
    "_ZSt9terminatev": "the same, as Clang has it",
    "_GLOBAL_OFFSET_TABLE_": "the linker's",
    "__stack_chk_fail": "reached only by a program that is broken already",
    "__assert_fail": "the same, in builds with assertions",
    "_ZSt21__glibcxx_assert_failPKciS0_S0_": "the standard library's assertions, the same",
}


def symbols(path, *options):
    """Names as the linker knows them."""
    lines = subprocess.run(["nm", *options, path], capture_output=True, text=True, check=True).stdout.splitlines()
    return {line.split()[-1].partition("@")[0] for line in lines if line.strip()}


def readable(symbol):
    return subprocess.run(["c++filt", symbol], capture_output=True, text=True, check=True).stdout.strip()


def main(arguments):
    if arguments[0] == "--objects":
        objects = [Path(name) for name in arguments[1:]]
    else:
        objects = [Path(arguments[0]) / folder / f"{name}.cpp.o" for folder, names in TICK.items() for name in names]
    missing = [path for path in objects if not path.exists()]
    for path in missing:
        print(f"{path}: not there; build it, or correct the list in tests/house/tick_imports.py")
    if missing:
        return 1
    imports = {path: symbols(path, "--undefined-only") for path in objects}
    if any(name.startswith(("__asan", "__tsan", "__ubsan")) for names in imports.values() for name in names):
        print("skipped: a sanitizer watches this build")
        return 0
    defined = set().union(*(symbols(path, "--defined-only") for path in objects))
    errors = 0
    for path, names in imports.items():
        for name in sorted(names - defined - HARMLESS.keys()):
            errors += 1
            print(f"{path.name} imports {readable(name)}, which is neither harmless nor defined in the tick's objects")
    print(f"{len(objects)} objects of the tick read, {errors} forbidden imports")
    return 1 if errors else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
