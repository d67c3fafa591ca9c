#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Fails if an object file of the tick imports anything that may allocate, lock, throw, wait or do I/O.

tick_imports.py <build folder>     the objects of palpate_library(TICK ...), by what the linker will see of them
tick_imports.py --objects A.o ...  these objects instead

Every undefined symbol of a tick's object must be harmless (HARMLESS) or defined in another, so the list is closed under calls:
what the tick calls is on it. Calls through virtual functions and function pointers leave no symbol; those of contact methods
are to be on the list (METHODS), the allocation trap of tests/runtime sees the others.
Instrumented builds import their sanitizer, so they are not checked.
"""
import subprocess
import sys
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2]
# Called through virtual functions, so that no symbol leads here: every source of a contact method but those that set it up and
# the table of them all.
METHODS = sorted(path for path in (SOURCE / "runtime/haptics/methods").glob("*.cpp")
                 if not path.stem.endswith("_setup") and path.stem != "contact_methods")
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
        rows = (Path(arguments[0]) / "tick_objects.txt").read_text().splitlines()
        object_of = {Path(source).resolve(): Path(built) for source, built in (row.split("\t") for row in rows)}
        objects = sorted(set(object_of.values()))
        left_out = [path for path in METHODS if path not in object_of]
        for path in left_out:
            print(f"{path.name}: a contact method's, but not of the tick; add it to TICK of runtime/haptics/CMakeLists.txt")
        if left_out or not objects:
            return 1
    missing = [path for path in objects if not path.exists()]
    for path in missing:
        print(f"{path}: not there; build it")
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
