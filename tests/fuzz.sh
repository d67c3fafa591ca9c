#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# tests/fuzz.sh [RUNS [READER ...]]: gives each reader RUNS inputs (10^6 without a number), each at most a second long, under
# AddressSanitizer and UndefinedBehaviorSanitizer, and prints what came of it. MORE_SEEDS=FOLDER: files of real patients
# to begin with, in FOLDER/<reader>. SEED=N: another run than that of seed 1.
set -euo pipefail
runs=${1:-1000000}
shift $(($# > 0))
source "$(dirname "${BASH_SOURCE[0]}")/../pipelines/set_up.sh"
readers=("$@")
[ ${#readers[@]} -gt 0 ] ||
    readers=(asset recording exercises stl message hand_path history case_file table bids recipes nodes seeds label_table
             label_map mesh dicom)
install_packages
mkdir -p "$root/build"
cd "$root"
cmake --preset fuzz >build/fuzz.configure.log || { cat build/fuzz.configure.log >&2; exit 1; }
cmake --build build/fuzz --target write_fuzz_samples write_fuzz_tool_samples "${readers[@]/#/fuzz_}" >&2

samples=build/fuzz/tests/fuzz/samples
build/fuzz/tests/write_fuzz_samples $samples
build/fuzz/tests/write_fuzz_tool_samples $samples
mkdir -p $samples/{case_file,exercises}
cp pipelines/cases/*.toml $samples/case_file
cp pipelines/exercises/*.toml $samples/exercises

status=0
printf '%-12s %10s %8s %8s %9s\n' reader inputs seconds edges findings
for reader in "${readers[@]}"; do
    tests/fuzz/run_target.sh build/fuzz/tests/fuzz_"$reader" "$runs" $samples/"$reader" || status=1
done
exit $status
