#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# What is too long for every run of tests/run.sh: all tests of the whole tree by Clang and by GCC, ten thousand inputs for each
# reader of the tools too, the lines that tests run, clang-tidy, the slow tests.
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/../pipelines/set_up.sh"
set_up clang coverage release fuzz:unit_tests
cd "$root"
tests/house/tidy.sh formats runtime tools
ctest --preset clang -j "$(nproc)"
ctest --preset release -j "$(nproc)"
ctest --test-dir build/fuzz -LE "slow|benchmark" -j "$(nproc)" --output-on-failure  # unit tests too, whose own code is looked at here
rm -rf build/coverage/coverage  # what other tests left
ctest --preset coverage -j "$(nproc)"
tests/coverage.sh
ctest --preset slow
