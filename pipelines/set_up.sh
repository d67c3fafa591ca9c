# SPDX-License-Identifier: Apache-2.0
# Sourced by pipelines/demo.sh and tests/run.sh: installs what packages.txt lists and builds presets. Who sets
# PALPATE_TESTS=OFF before needs no package of the tests and builds none; ONCE: each test in one preset.
# Every step does nothing when there is nothing to do.

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
export CCACHE_BASEDIR="$root"

install_packages() {
    local wanted missing=() package as_root=()
    wanted=$(cat "$root/packages.txt")
    [ "${PALPATE_TESTS:-ON}" != OFF ] || wanted=${wanted%%# tests*}
    wanted=$(sed 's/#.*//' <<<"$wanted")
    for package in $wanted; do
        [ "$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null)" = installed ] || missing+=("$package")
    done
    [ ${#missing[@]} -gt 0 ] || return 0
    echo "Installing ${#missing[@]} Debian packages" >&2
    if [ "$(id -u)" -ne 0 ]; then
        command -v sudo >/dev/null || { echo "set_up: installing needs root or sudo" >&2; return 1; }
        as_root=(sudo)
    fi
    "${as_root[@]}" apt-get update -q
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends "${missing[@]}"
}

build() { # preset [target]
    cmake --preset "$1" -S "$root" -D PALPATE_TESTS="${PALPATE_TESTS:-ON}" >"$root/build/$1.configure.log" 2>&1 || { cat "$root/build/$1.configure.log" >&2; return 1; }
    cmake --build "$root/build/$1" ${2:+--target "$2"}
}

set_up() { # preset[:target] ...
    local wanted
    install_packages
    mkdir -p "$root/build"
    for wanted in "$@"; do
        echo "Building ${wanted/:/, target }" >&2
        # shellcheck disable=SC2086 # a preset and its target are two words
        (cd "$root" && build ${wanted/:/ })
    done
}
