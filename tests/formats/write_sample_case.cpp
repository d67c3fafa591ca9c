// SPDX-License-Identifier: Apache-2.0
// write_sample_case FILE [hierarchical]: writes the made-up patient, for tests in other languages; with its
// compliance by blocks if asked to.
#include <string_view>

#include "formats/asset/asset.hpp"
#include "tests/formats/sample_case.hpp"

int main(int argc, char** argv) {
    const bool hierarchical = argc == 3 && std::string_view(argv[2]) == "hierarchical";
    if (argc != 2 && !hierarchical) return 2;
    palpate::Case patient_case = palpate::sample::sample_case(4);
    if (hierarchical) {
        constexpr double accuracy = 1e-4;
        palpate::DeformableBody& wall = patient_case.deformable_bodies[0];
        wall = palpate::sample::with_hierarchical_compliance(wall, 3, accuracy);
    }
    palpate::asset::write_asset(argv[1], patient_case);
    return 0;
}
