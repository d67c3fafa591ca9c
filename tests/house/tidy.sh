#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# tidy.sh <folder> ...: holds the code of these folders of the root against .clang-tidy. Says what it found and, last,
# how much it read.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
log=build/tidy/tidy.log
mkdir -p build/tidy
cmake --preset tidy >"$log"
folders=$(IFS='|' && echo "$*")
status=0
# What CMake compiles together is read together: so headers are read once for up to 16 files.
run-clang-tidy-16 -p build/tidy -quiet "^$PWD/(build/tidy/)?($folders)/" >"$log" 2>&1 || status=1
grep -vE '^clang-tidy-16 |^[0-9]+ warnings? generated|^$' "$log" || true
echo "tidy: $(grep -c '^clang-tidy-16 ' "$log") compilations of $* read, $(grep -cE '(error|warning): ' "$log") findings"
exit $status
