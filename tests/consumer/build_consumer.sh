#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
set -euo pipefail
cmake=$1
build=$2
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
rm -rf "$build/consumer"
"$cmake" --install "$build" --prefix "$build/consumer/prefix" >/dev/null
"$cmake" -S "$here/project" -B "$build/consumer/build" -G Ninja -DCMAKE_BUILD_TYPE=Release \
    -DCMAKE_PREFIX_PATH="$build/consumer/prefix" >/dev/null
"$cmake" --build "$build/consumer/build"
"$build/consumer/build/consumer"
