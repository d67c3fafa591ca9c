#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Every source file names its licence in its first two lines: GPL where CGAL and CHOLMOD are near, Apache elsewhere.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
find formats tools runtime tests docs pipelines sample_data cmake .ci \
    \( -name '*.cpp' -o -name '*.hpp' -o -name '*.py' -o -name '*.sh' -o -name '*.cmake' -o -name 'CMakeLists.txt' \
    -o -name Snakefile -o -path .ci/run \) -not -path '*/cache/*' -print0 | xargs -0 awk '
    function finish() { if (file != "" && !named) { print file ": no \x27" licence "\x27 line"; status = 1 } }
    FNR == 1 {
        finish()
        file = FILENAME; named = 0; licence = "(Apache-2.0|GPL-3.0-or-later)"
        if (file ~ /^(formats|runtime)\// || file ~ /^tools\/(cli\/|CMakeLists.txt$)/) licence = "Apache-2.0"
        else if (file ~ /^tools\//) licence = "GPL-3.0-or-later"
    }
    FNR <= 2 && $0 ~ "SPDX-License-Identifier: " licence "$" { named = 1; nextfile }
    FNR == 2 { nextfile }
    END { finish(); exit status }'
