// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "runtime/visual/tissue/tissue_colours.hpp"
#include "tests/formats/sample_case.hpp"
#include "tests/runtime/visual/luminance.hpp"

namespace palpate {
namespace {

using visual::Rgb;
using visual::tissue_look;

bool look_alike(const std::string& a, const std::string& b) {
    return tissue_look(a).colour == tissue_look(b).colour;
}

TEST(TissueColours, are_those_of_the_structure_however_its_name_is_written) {
    for (const char* name : {"Kidney", "kidney_left", "Left Kidney", "KIDNEYS"})
        EXPECT_TRUE(look_alike(name, "kidney")) << name;
    EXPECT_TRUE(look_alike("vertebrae_L1", "bone"));
    EXPECT_TRUE(look_alike("rib_left_3", "skull"));
    EXPECT_TRUE(look_alike("inferior_vena_cava", "portal_vein_and_splenic_vein"));
    EXPECT_TRUE(look_alike("gluteus_maximus_right", "muscle"));
}

TEST(TissueColours, the_last_word_that_is_known_counts) {
    EXPECT_TRUE(look_alike("liver tumour", "tumor"));
    EXPECT_TRUE(look_alike("kidney_cyst_left", "cyst"));
    EXPECT_TRUE(look_alike("lung_vessels", "vessel"));
    EXPECT_FALSE(look_alike("gallbladder", "urinary_bladder"));
    EXPECT_FALSE(look_alike("masseter", "mass"));
    EXPECT_FALSE(look_alike("hippocampus", "hip"));
}

TEST(TissueColours, neighbours_differ_in_lightness_for_eyes_that_tell_few_hues) {
    constexpr float seen = 15;  // of 255
    const std::vector<std::pair<std::string, std::string>> neighbours{
        {"liver", "kidney"},  {"liver", "gallbladder"}, {"liver", "tumour"},
        {"wall", "tumour"},   {"wall", "skull"},        {"gallbladder", "kidney"},
        {"spleen", "kidney"}, {"muscle", "fat"},        {"liver", "lung"}};
    for (const auto& [a, b] : neighbours)
        EXPECT_GT(std::abs(luminance(tissue_look(a).colour) - luminance(tissue_look(b).colour)), seen)
            << a << ", " << b;
}

TEST(TissueColours, unknown_names_get_muted_ones_of_their_own) {
    EXPECT_TRUE(look_alike("structure_x", "structure_x"));
    EXPECT_FALSE(look_alike("structure_x", "structure_y"));
    for (const char* name : {"structure_x", "structure_y", "", "42"}) {
        const Rgb colour = tissue_look(name).colour;
        EXPECT_GE(colour.minCoeff(), 60) << name;
        EXPECT_LE(colour.maxCoeff(), 240) << name;
        EXPECT_LT(colour.maxCoeff() - colour.minCoeff(), 110) << name;
    }
}

TEST(TissueColours, that_an_asset_asks_for_go_before_those_of_names) {
    Case patient_case = sample::sample_case(4);
    RigidBody& skull = patient_case.rigid_bodies[0];
    skull.colour = Colour{1, 2, 3};
    EXPECT_EQ(visual::look_of(skull).colour, Rgb(1, 2, 3));
    EXPECT_EQ(visual::look_of(skull).wetness, tissue_look("skull").wetness);
    skull.colour.reset();
    EXPECT_EQ(visual::look_of(skull).colour, tissue_look("skull").colour);

    DeformableBody& wall = patient_case.deformable_bodies[0];
    wall.colour = Colour{4, 5, 6};
    wall.region_colours = {{1, {7, 8, 9}}, {2, {10, 11, 12}}};
    EXPECT_EQ(visual::look_of(wall).colour, Rgb(7, 8, 9));  // region 1 is the larger one
    EXPECT_EQ(visual::chosen_colour(wall, 2), Rgb(10, 11, 12));
    wall.region_colours.clear();
    EXPECT_EQ(visual::look_of(wall).colour, Rgb(4, 5, 6));
    EXPECT_FALSE(visual::chosen_colour(wall, 2));
    wall.colour.reset();
    EXPECT_EQ(visual::look_of(wall).colour, tissue_look("tissue").colour);
}

}  // namespace
}  // namespace palpate
