// SPDX-License-Identifier: Apache-2.0
// write_sample_case FILE: writes the made-up patient, for tests in other languages.
#include "formats/asset/asset.hpp"
#include "tests/formats/sample_case.hpp"

int main(int argc, char** argv) {
    if (argc != 2) return 2;
    palpate::write_asset(argv[1], palpate::sample::sample_case(4));
    return 0;
}
