#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Installs what is missing, builds the release and both sanitizer presets, and runs all tests but the slow ones. Unit tests of
# formats and runtime run under AddressSanitizer, those of them that run threads under ThreadSanitizer too, all others in the
# release. What runs them all in each, and clang-tidy, is tests/before_release.sh.
# Closes with ctest's own summary; skipped tests are printed with their reason.
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/../pipelines/set_up.sh"
PALPATE_TESTS=ONCE
set_up release asan:unit_tests tsan:thread_tests
cd "$root"
# Without these two volumes the tests of the demo's cases are skipped.
sample_data/unpack.py build/sample_data || echo "run.sh: the sample volumes could not be unpacked" >&2

status=0
run_preset() { # preset
    echo; echo "== Tests of preset $1"
    ctest --preset "$1" -j "$(nproc)" --output-junit "$root/build/$1/tests.xml" 2>&1 | tee "$root/build/$1/tests.log" || status=1
    python3 tests/skip_reasons.py "build/$1/tests.xml"
}
run_preset asan
run_preset tsan
run_preset release
# The skip reasons stand between ctest's summary and the end; say the summary of all three last.
echo
for preset in asan tsan release; do
    echo "$preset:"
    grep -E '^[0-9]+% tests passed|^No tests were found' "build/$preset/tests.log"
done
exit $status
