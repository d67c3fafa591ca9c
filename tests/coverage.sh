#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# tests/coverage.sh: which part of the lines of each room of formats and runtime the tests of preset coverage ran, as they
# left it in build/coverage/coverage. Ends with 1 if formats or runtime have less than 90 %; rooms that the preset does not
# build are named and do not count.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
build=build/coverage
llvm-profdata-16 merge -sparse "$build"/coverage/*.profraw -o "$build/coverage/tests.profdata"
objects=()
for object in "$build"/bin/* "$build"/tests/*; do
    [ -f "$object" ] && [ -x "$object" ] && objects+=(-object "$object")
done
llvm-cov-16 export -summary-only -instr-profile "$build/coverage/tests.profdata" "${objects[@]:1}" \
    -ignore-filename-regex "^($PWD/)?(build|tests|tools|sample_data)/|^/usr/" >"$build/coverage/summary.json" 2>"$build/coverage/warnings" ||
    { cat "$build/coverage/warnings" >&2; exit 1; }
cat "$build/coverage/warnings"  # of functions that it leaves out, for binaries compiled them differently
python3 tests/coverage_by_room.py "$build/coverage/summary.json"
