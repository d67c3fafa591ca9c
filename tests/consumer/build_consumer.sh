#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# build_consumer.sh CMAKE BUILD: installs a build, and lets a foreign project touch a sample asset with it, compiled for
# other vector instructions than ours where this processor has them.
set -euo pipefail
cmake=$1
build=$2
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
consumer=$build/consumer
rm -rf "$consumer"
"$cmake" --install "$build" --prefix "$consumer/prefix" >/dev/null
"$build/tests/write_sample_asset" "$consumer/sample.vtkhdf"
flags=("")
if grep -qw avx2 /proc/cpuinfo; then flags+=("-mavx2 -mfma"); fi
for flag in "${flags[@]}"; do
    "$cmake" -S "$here/project" -B "$consumer/build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_FLAGS="$flag" \
        -DCMAKE_PREFIX_PATH="$consumer/prefix" >/dev/null
    "$cmake" --build "$consumer/build"
    "$consumer/build/consumer" "$consumer/sample.vtkhdf"
done

# Who goes past our targets is told at once.
if told=$("${CXX:-c++}" -std=c++20 -fsyntax-only -mavx -isystem /usr/include/eigen3 -I "$consumer/prefix/include/palpate" \
        -include runtime/haptics/haptic_model.hpp -x c++ /dev/null 2>&1); then
    echo "headers were taken with another layout of Eigen's types" >&2
    exit 1
fi
grep -q "link Palpate's CMake targets" <<<"$told"
