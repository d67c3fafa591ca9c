// SPDX-License-Identifier: Apache-2.0
// Writes the sample patient, with a true compliance, as an asset for tests of commands; without its skull if
// asked to.
#include <iostream>
#include <string_view>

#include "formats/asset/asset.hpp"
#include "tests/formats/sample_case.hpp"
#include "tests/runtime/elastic_cube.hpp"

int main(int argc, char** argv) {
    const bool soft = argc == 3 && std::string_view(argv[2]) == "soft";
    if (argc != 2 && !soft) {
        std::cerr << "usage: write_sample_asset OUT.vtkhdf [soft]\n";
        return 2;
    }
    palpate::Case patient_case = palpate::sample::sample_case();
    patient_case.deformable_bodies = {palpate::sample::true_elastic_cube(5)};
    if (soft) patient_case.rigid_bodies.clear();
    palpate::asset::write_asset(argv[1], patient_case);
    return 0;
}
