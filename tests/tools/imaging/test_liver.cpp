// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <gtest/gtest.h>

#include "formats/model/errors.hpp"
#include "tests/tools/imaging/refusals.hpp"
#include "tests/tools/imaging/run_recipes.hpp"
#include "tools/imaging/voxels/label_statistics.hpp"

namespace palpate {
namespace {

using namespace imaging;
using namespace test;

// Liver, tumour and vessels on a body twice life's smallness: the liver's balls and necks scale with it.
const std::string small_liver = "liver: recipe=liver seeds=-14,-6,16;-30,-6,-4;4,-8,0 neck_mm=4 gap_mm=10";

TEST(Recipes, liver_takes_its_tumour_and_vessels_along_and_both_can_be_found_inside) {
    const Phantom abdomen = abdomen_phantom({.samples_per_axis = 2, .noise_hu = 15});
    LabelMap whole = abdomen.truth;
    for (std::uint16_t& label : whole.labels) label = label == 2 ? 1 : label;
    EXPECT_GT(dice(run(&abdomen.volume, nullptr, {small_liver}), "liver", whole, "liver"), coarse_dice);
    const LabelMap map = run(&abdomen.volume, nullptr,
                             {small_liver, "tumour: recipe=tumour inside=liver seeds=-22,-10,4",
                              "vessels: recipe=vessels inside=liver max_radius_mm=6 seeds=-12,6,-8"});
    EXPECT_GT(dice(map, "tumour", abdomen.truth, "tumour"), coarse_dice);
    EXPECT_EQ(label_statistics(map)[1].components, 1U);
    std::size_t found = 0, true_vessels = 0;
    for (std::size_t i = 0; i < map.labels.size(); ++i) {
        found += map.labels[i] == 3;
        true_vessels += map.labels[i] == 3 && abdomen.truth.labels[i] == 3;
    }
    EXPECT_GT(found, 50U);
    EXPECT_GT(true_vessels * 10, found * 6);  // a tube of three voxels is mostly border
}

// The phantom with a brighter ball in whatever lies there, within the liver alone if so asked.
Phantom abdomen_with_ball(const Eigen::Vector3d& center, double radius, bool in_liver) {
    Phantom abdomen = abdomen_phantom({.samples_per_axis = 2, .noise_hu = 15});
    const ImageGrid& grid = abdomen.volume.grid;
    std::size_t offset = 0;
    for (int k = 0; k < grid.size[2]; ++k)
        for (int j = 0; j < grid.size[1]; ++j)
            for (int i = 0; i < grid.size[0]; ++i, ++offset)
                if ((!in_liver || abdomen.truth.labels[offset] == 1) &&
                    (grid.point_of(Eigen::Vector3d(i, j, k)) - center).norm() < radius)
                    abdomen.volume.values[offset] += 60;
    return abdomen;
}

const std::string liver_beside_ball = "liver: recipe=liver seeds=-14,-6,16;4,-8,0 neck_mm=4 gap_mm=4";

// Half of what the ball holds of the liver, which is a seventh of it: without it the overlap loses as much.
constexpr double regained_dice = 0.05;

TEST(Recipes, liver_takes_a_lesion_at_its_border_along_where_a_point_lies_in_it) {
    const Phantom abdomen = abdomen_with_ball({-30, -6, -4}, 15, true);
    LabelMap whole = abdomen.truth;
    for (std::uint16_t& label : whole.labels) label = label == 2 ? 1 : label;
    const auto found = [&](const std::string& structure) {
        return dice(run(&abdomen.volume, nullptr, {structure}), "liver", whole, "liver");
    };
    const double with = found(liver_beside_ball + " lesion_seeds_mm=-30,-6,-4");
    EXPECT_GT(with, found(liver_beside_ball) + regained_dice);
    EXPECT_GT(with, coarse_dice);
}

TEST(Recipes, liver_refuses_lesions_that_lie_apart_from_it_or_run_out_of_it) {
    const auto refusal = [&](const Phantom& abdomen, const std::string& lesion) {
        return test::refusal_of<Error>(
            [&] { run(&abdomen.volume, nullptr, {liver_beside_ball + " lesion_seeds_mm=" + lesion}); });
    };
    EXPECT_SAYS(refusal(abdomen_with_ball({27, 17, 0}, 8, false), "27,17,0"), "lies apart from it");
    EXPECT_SAYS(refusal(abdomen_phantom(), "34,20,0"), "ran out of it");
}

TEST(Recipes, liver_hardly_depends_on_where_the_seeds_are) {
    const Phantom abdomen = abdomen_phantom({.samples_per_axis = 2, .noise_hu = 15});
    const LabelMap map = run(&abdomen.volume, nullptr, {small_liver});
    for (const char* seeds : {"-10,-8,14", "-12,-2,12;-33,-8,-6", "-18,-6,-18;0,-8,4;-20,6,10;-30,-6,-8"}) {
        const LabelMap other = run(&abdomen.volume, nullptr,
                                   {"liver: recipe=liver neck_mm=4 gap_mm=10 seeds=" + std::string(seeds)});
        EXPECT_GT(dice(map, "liver", other, "liver"), 0.97) << seeds;
    }
}

TEST(Recipes, liver_is_found_however_it_was_imaged) {
    for (const auto& [name, options] : imagings()) {
        SCOPED_TRACE(name);
        const Phantom abdomen = abdomen_phantom(options);
        LabelMap whole = abdomen.truth;
        for (std::uint16_t& label : whole.labels) label = label == 2 ? 1 : label;
        const LabelMap map = run(&abdomen.volume, nullptr, {small_liver});
        EXPECT_GT(dice(map, "liver", whole, "liver"), coarse_dice);
    }
}

// An image without air or HU, brighter `times` over.
Volume as_mri(const Volume& ct, float times) {
    Volume mri = ct;
    for (float& value : mri.values) value = times * std::max(0.0F, value + 100);
    return mri;
}

TEST(Recipes, organ_finds_in_mri_of_any_brightness_what_liver_finds_in_ct) {
    const Phantom abdomen = abdomen_phantom({.samples_per_axis = 2, .noise_hu = 8});
    const std::string small_organ =
        "liver: recipe=organ seeds=-14,-6,16;-30,-6,-4;4,-8,0 neck_mm=4 gap_mm=10";
    LabelMap whole = abdomen.truth;
    for (std::uint16_t& label : whole.labels) label = label == 2 ? 1 : label;
    EXPECT_EQ(run(&abdomen.volume, nullptr, {small_organ}).labels,
              run(&abdomen.volume, nullptr, {small_liver}).labels);
    const Volume dim = as_mri(abdomen.volume, 0.5F), bright = as_mri(abdomen.volume, 3);
    const LabelMap found = run(&dim, nullptr, {small_organ});
    EXPECT_GT(dice(found, "liver", whole, "liver"), coarse_dice);
    EXPECT_EQ(run(&bright, nullptr, {small_organ}).labels, found.labels);
}

}  // namespace
}  // namespace palpate
