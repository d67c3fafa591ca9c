#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Installs what is missing, builds the release and both sanitizer presets (of tsan the tests that run threads), runs all
# tests but the slow ones, and clang-tidy over formats and runtime, whose lines it counts.
# Closes with ctest's own summary; skipped tests are printed with their reason.
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/../pipelines/set_up.sh"
set_up release asan tsan:thread_tests
cd "$root"
# Without these two volumes the tests of the demo's cases are skipped.
sample_data/unpack.py build/sample_data || echo "run.sh: the sample volumes could not be unpacked" >&2

status=0
run_preset() { # preset
    echo; echo "== Tests of preset $1"
    ctest --preset "$1" -j "$(nproc)" --output-junit "$root/build/$1/tests.xml" 2>&1 | tee "$root/build/$1/tests.log" || status=1
    python3 tests/skip_reasons.py "build/$1/tests.xml"
}
rm -rf build/asan/coverage  # what other tests left
run_preset asan
echo; echo "== Lines that preset asan ran"
covered=$(tests/coverage.sh) || status=1
echo "$covered"
run_preset tsan
# Much of what follows waits for clocks and windows; meanwhile clang-tidy takes what is idle.
setsid nice -n 19 tests/house/tidy.sh formats runtime >build/tidy.log &
tidy=$!
trap 'kill -- -$tidy' EXIT
run_preset release
echo; echo "== clang-tidy"
wait $tidy || status=1
trap - EXIT
tidied=$(cat build/tidy.log)
echo "$tidied"
# The skip reasons stand between ctest's summary and the end; say the summary of all three last.
echo
for preset in asan tsan release; do
    echo "$preset:"
    grep -E '^[0-9]+% tests passed|^No tests were found' "build/$preset/tests.log"
done
grep -E '^(formats|runtime) ' <<<"$covered" || true
tail -n 1 <<<"$tidied"
exit $status
