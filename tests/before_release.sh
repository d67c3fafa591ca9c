#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# What is too long for every run of tests/run.sh: the whole tree by Clang with its tests, the lines that tests run with the
# window's among them, clang-tidy over the tools, the slow tests.
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/../pipelines/set_up.sh"
set_up clang coverage release
cd "$root"
tests/house/tidy.sh tools
ctest --preset clang -j "$(nproc)"
rm -rf build/coverage/coverage  # what other tests left
ctest --preset coverage -j "$(nproc)"
tests/coverage.sh coverage
ctest --preset slow
