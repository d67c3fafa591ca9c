#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# tests/endurance.sh ASSET [VIRTUAL-SECONDS [SECONDS]]: touch by a virtual clock for 8 hours, then the trainer in a display of
# its own for 10 minutes, both at random on ASSET and under AddressSanitizer, LeakSanitizer and
# UndefinedBehaviorSanitizer. Prints how the memory of each grew. Ends with 1 if one of them complains, leaks, or grows
# by more than 1 %. It builds preset endurance.
set -euo pipefail
asset=${1:?which asset?}
source "$(dirname "${BASH_SOURCE[0]}")/../pipelines/set_up.sh"
install_packages
mkdir -p "$root/build"
PALPATE_TESTS=OFF
for program in palpate-touch palpate-train; do (cd "$root" && build endurance $program) >&2; done

status=0
last() { # program options ...
    "$root"/tests/watch_memory.py "$root/build/endurance/bin/$1" "$asset" "${@:2}" || status=1
}
last palpate-touch --script random --virtual-clock --seconds "${2:-28800}" --quiet
last palpate-train --script random --seconds "${3:-600}" --quiet
exit $status
