#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# run_target.sh FUZZER RUNS [FOLDER ...]: runs a fuzz target from what was found before, its seeds and the files of
# FOLDERs on, and prints a row: reader, inputs run, seconds, edges covered, findings. A finding ends the run and is kept
# beside the fuzzer. MORE_SEEDS/<reader> is a folder more, if there is one. SECONDS_PER_INPUT, 1 without it, are those of
# the clock on the wall: more where other tests run beside it. SEED, 1 without it, is the fuzzer's: another one, other inputs.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
fuzzer=$1 runs=$2
shift 2
reader=${fuzzer##*/fuzz_}
folders=()
for folder in "$here/findings/$reader" "$here/seeds/$reader" "${MORE_SEEDS:-none}/$reader" "$@"; do
    [ -d "$folder" ] && folders+=("$folder")
done
[ -d /dev/shm ] && export TMPDIR=/dev/shm  # every input is a file
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir "$work/corpus"
export LSAN_OPTIONS=suppressions=$here/leaks_of_others.txt:print_suppressions=0
case $reader in asset | recording) longest=65536 ;; *) longest=8192 ;; esac
start=$SECONDS status=0
TMPDIR=$work "$fuzzer" -runs="$runs" -seed="${SEED:-1}" -max_len=$longest -timeout="${SECONDS_PER_INPUT:-1}" -rss_limit_mb=2048 -malloc_limit_mb=512 \
    -print_final_stats=1 -artifact_prefix="$fuzzer-" "$work/corpus" "${folders[@]}" >"$work/log" 2>&1 || status=$?
edges=$(sed -nE 's/.*cov: ([0-9]+).*/\1/p' "$work/log" | tail -n 1)
done=$(sed -nE 's/.*number_of_executed_units: //p' "$work/log" | tail -n 1)
found=0
[ $status -eq 0 ] || { found=1; tail -n 60 "$work/log" >&2; }
printf '%-12s %10s %8s %8s %4s\n' "$reader" "${done:-?}" $((SECONDS - start)) "${edges:-?}" $found
exit $status
