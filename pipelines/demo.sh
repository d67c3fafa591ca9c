#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# From two real volumes to two organs that can be felt: build/demo/{nasopharynx,liver}.{vtkhdf,html}.
# Needs Debian 12 with root or sudo; installs what is missing, builds palpate's commands, and does nothing twice.
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/set_up.sh"
PALPATE_TESTS=OFF
set_up release:commands

bin=$root/build/release/bin
mkdir -p "$root/build/demo"
"$root/sample_data/unpack.py" "$root/build/sample_data"
started=$SECONDS
make_case() { # name
    local made=$root/build/demo/$1
    rm -f "$made.json" "$made.verify.json"
    # The trainer takes exercises from beside the asset; what a teacher changed there stays.
    [ -e "$made-exercises.toml" ] || cp "$root/pipelines/exercises/$1.toml" "$made-exercises.toml"
    "$bin/palpate" build "$root/pipelines/cases/$1.toml" -o "$made.vtkhdf" --json "$made.json" &&
        "$bin/palpate" verify "$made.vtkhdf" --json "$made.verify.json"
}
# Side by side: most of a build is one thread's work.
makers=()
for name in nasopharynx liver; do
    make_case "$name" > >(sed -u "s/^/$name: /") 2>&1 &
    makers+=($!)
done
status=0
for maker in "${makers[@]}"; do wait "$maker" || status=$?; done
[ "$status" -eq 0 ] || exit "$status"
for name in nasopharynx liver; do
    python3 "$root/pipelines/summary.py" "$root/build/demo/$name.json" "$root/build/demo/$name.verify.json"
done
echo "Both cases took $((SECONDS - started)) s after the build."
echo "Touch one: build/release/bin/palpate train build/demo/liver.vtkhdf"
