#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Makes the Debian packages and their bill of materials in build/packages. Needs Debian 12 with root or sudo; installs
# what is missing and builds palpate.
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/set_up.sh"
PALPATE_TESTS=OFF
set_up release
cpack --config "$root/build/release/CPackConfig.cmake" -B "$root/build/packages"
