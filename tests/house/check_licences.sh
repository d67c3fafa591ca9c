#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Every source file names its licence in its first two lines: GPL where CGAL and CHOLMOD are near, Apache elsewhere.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
status=0
while IFS= read -r -d '' file; do
    case $file in
        tools/cli/* | tools/CMakeLists.txt) licence=Apache-2.0 ;;
        tools/*) licence=GPL-3.0-or-later ;;
        formats/* | runtime/*) licence=Apache-2.0 ;;
        *) licence='(Apache-2.0|GPL-3.0-or-later)' ;;
    esac
    head -n 2 "$file" | grep -qE "SPDX-License-Identifier: $licence\$" || { echo "$file: no '$licence' line"; status=1; }
done < <(find formats tools runtime tests docs pipelines sample_data cmake .ci \
    \( -name '*.cpp' -o -name '*.hpp' -o -name '*.py' -o -name '*.sh' -o -name '*.cmake' -o -name 'CMakeLists.txt' \
    -o -name Snakefile -o -path .ci/run \) -not -path '*/cache/*' -print0)
exit $status
