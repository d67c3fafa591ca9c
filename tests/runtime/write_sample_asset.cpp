// SPDX-License-Identifier: Apache-2.0
// Writes the sample patient, with a true compliance, as an asset for tests of commands; if asked to, without
// its skull, with notes on how it was made, with tissue that is there twice or that is to be felt deformed
// far, or with made-up figures of how stiff it feels.
#include <iostream>
#include <string_view>

#include "formats/asset/asset.hpp"
#include "tests/formats/sample_case.hpp"
#include "tests/runtime/elastic_cube.hpp"

int main(int argc, char** argv) {
    const std::string_view variant = argc == 3 ? argv[2] : "";
    const bool soft = variant == "soft", noted = variant == "noted", twice = variant == "twice",
               far = variant == "deformed_far", stiffness = variant == "stiffness";
    if (argc != 2 && !soft && !noted && !twice && !far && !stiffness) {
        std::cerr
            << "usage: write_sample_asset OUT.vtkhdf [soft | noted | twice | deformed_far | stiffness]\n";
        return 2;
    }
    palpate::Case patient_case = palpate::sample::sample_case();
    patient_case.deformable_bodies = {twice ? palpate::sample::true_elastic_cubes(5, {6, 3, 0})
                                            : palpate::sample::true_elastic_cube(5)};
    palpate::DeformableBody& organ = patient_case.deformable_bodies[0];
    organ.large_deformation = far;
    if (stiffness) organ.feel = palpate::sample::made_up_feel(organ, patient_case.haptics.tool_radius);
    if (soft) patient_case.rigid_bodies.clear();
    if (noted)
        patient_case.provenance =
            R"({"notes":["The skull is a ball of 15 mm that no scan shows: place and size of it are made up.",)"
            R"("The scan's values rise along each axis and stand for no tissue."]})";
    palpate::asset::write_asset(argv[1], patient_case);
    return 0;
}
