// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "runtime/training/lay_out.hpp"
#include "tests/formats/sample_case.hpp"
#include "tests/formats/scratch.hpp"
#include "tests/runtime/elastic_cube.hpp"

namespace palpate {
namespace {

using namespace training;
using Eigen::Vector3d;

// The sample patient: a cube [0, 20]^3 held at z = 0 with a "tumour" in its middle.
class LayOut : public ::testing::Test {
  protected:
    static Case make_case() {
        Case patient_case = sample::sample_case();
        patient_case.deformable_bodies = {sample::true_elastic_cube(5)};
        return patient_case;
    }
    const ExerciseRecipe& standard(const std::string& name) const {
        return *std::ranges::find(recipes_, name, &ExerciseRecipe::name);
    }
    const std::vector<ExerciseRecipe> recipes_ = standard_exercises(false);
    const Case case_ = make_case();
    haptics::HapticModel model_{case_};
    const FirstEye above_{.place = {10, 10, 100}};
    const session::TouchTarget start_ = session::choose_touch_target(case_, model_, "", std::nullopt);
};

TEST_F(LayOut, what_a_body_encloses_is_hidden_below_its_free_surface) {
    const auto regions = hidden_regions(case_);
    ASSERT_EQ(regions.size(), 1U);
    EXPECT_EQ(regions[0].name, "tumour");
    EXPECT_GT(regions[0].above.z(), 0);
    EXPECT_GT(regions[0].depth, 1);
    EXPECT_LT(regions[0].depth, 10);
}

TEST_F(LayOut, marks_lie_apart_on_the_side_of_the_start_and_the_tool_comes_there) {
    ExerciseRecipe recipe = standard("touch");
    recipe.tolerance = 2;
    const auto exercise = lay_out(recipe, case_, model_, start_, above_);
    ASSERT_TRUE(exercise);
    ASSERT_EQ(exercise->places.size(), 5U);
    for (std::size_t i = 0; i < 5; ++i) {
        EXPECT_NEAR(exercise->places[i].z(), 20, 1e-9);
        for (std::size_t j = 0; j < i; ++j) EXPECT_GE((exercise->places[i] - exercise->places[j]).norm(), 4);
    }
    EXPECT_EQ(lay_out(recipe, case_, model_, start_, above_)->places, exercise->places);
    recipe.seed = 2;
    EXPECT_NE(lay_out(recipe, case_, model_, start_, above_)->places, exercise->places);
}

TEST_F(LayOut, marks_and_lines_lie_where_the_eye_sees_them_if_there_is_room) {
    // From close to the top's plane, beside x = 0: what lies farther away is seen too flat.
    const FirstEye low{.place = {0, 10, 28}};
    ExerciseRecipe recipe = standard("touch");
    recipe.count = 3;
    recipe.tolerance = 1;
    const auto marks = lay_out(recipe, case_, model_, start_, low);
    for (const Vector3d& mark : marks->places)
        EXPECT_GT((low.place - mark).normalized().z(), 0.5 - 1e-9) << mark.transpose();
    const FirstEye near{.place = {4, 10, 26}};
    const auto line = lay_out(standard("trace"), case_, model_, start_, near);
    for (const Vector3d& point : line->places)
        EXPECT_GT((near.place - point).normalized().z(), 0.5 - 1e-9) << point.transpose();
    const FirstEye below{.place = {10, 10, -100}};
    EXPECT_EQ(lay_out(recipe, case_, model_, start_, below)->places.size(), 3U) << "better unseen than none";
}

TEST_F(LayOut, marks_without_room_are_refused) {
    ExerciseRecipe recipe = standard("touch");
    recipe.count = 500;
    recipe.written_at = "exercises.toml:7";
    EXPECT_THAT(sample::refusal([&] { lay_out(recipe, case_, model_, start_, above_); }),
                ::testing::HasSubstr("exercises.toml:7"));
}

TEST_F(LayOut, a_search_is_for_the_hidden_region_and_needs_one) {
    ExerciseRecipe recipe = standard("find");
    const auto exercise = lay_out(recipe, case_, model_, start_, above_);
    EXPECT_EQ(exercise->region, "tumour");
    EXPECT_EQ(exercise->places.front(), hidden_regions(case_)[0].above);
    for (const Vector3d& point : exercise->outline)
        EXPECT_LT((point - exercise->places.front()).norm(), 20) << "around what is hidden";
    EXPECT_GT(exercise->outline.size(), 5U);
    recipe.region = "tumor";
    EXPECT_THAT(sample::refusal([&] { lay_out(recipe, case_, model_, start_, above_); }),
                ::testing::HasSubstr("'tumour'"));
    Case plain = case_;
    std::ranges::fill(plain.deformable_bodies[0].mesh.regions, 1);
    EXPECT_FALSE(lay_out(standard("find"), plain, model_, start_, above_));
}

TEST_F(LayOut, a_line_runs_along_the_surface_and_keeps_off_its_edges) {
    const auto exercise = lay_out(standard("trace"), case_, model_, start_, above_);
    EXPECT_GT(length_of(exercise->places), 10);
    for (const Vector3d& place : exercise->places) {
        EXPECT_NEAR(place.z(), 20, 1e-9);
        EXPECT_GT(place.head<2>().minCoeff(), 0) << "on an edge";
        EXPECT_LT(place.head<2>().maxCoeff(), 20) << "on an edge";
    }
}

TEST_F(LayOut, points_of_a_written_line_are_joined_along_the_surface) {
    ExerciseRecipe recipe = standard("trace");
    // Over the cube's edge from its top to its side: straight on, the line would run through it.
    recipe.places = {{10, 10, 20}, {20, 10, 10}};
    const auto exercise = lay_out(recipe, case_, model_, start_, above_);
    EXPECT_GT(exercise->places.size(), 10U);
    EXPECT_EQ(exercise->places.front(), recipe.places.front());
    EXPECT_EQ(exercise->places.back(), recipe.places.back());
    for (const Vector3d& place : exercise->places)
        EXPECT_NEAR(std::max(place.x(), place.z()), 20, 1e-4) << place.transpose();
    recipe.least_force = 0.01;
    recipe.most_force = 0.2;
    EXPECT_EQ(lay_out_settled(recipe, case_, model_)->places, exercise->places);
}

TEST_F(LayOut, forces_are_what_this_tissue_answers_and_those_of_the_file_go_before) {
    ExerciseRecipe recipe = standard("free");
    const auto exercise = lay_out(recipe, case_, model_, start_, above_);
    EXPECT_NEAR(exercise->least_force, force_at_depth(model_, start_.place, 1), 0.06 * exercise->least_force);
    EXPECT_GT(exercise->most_force, 2 * exercise->least_force);
    EXPECT_LE(exercise->most_force, case_.haptics.max_force);
    recipe.most_force = 0.25;
    EXPECT_EQ(lay_out(recipe, case_, model_, start_, above_)->most_force, 0.25);
}

TEST_F(LayOut, a_press_is_of_the_first_tool_whether_there_are_others_or_not) {
    haptics::HapticModel two(case_, haptics::usual_contact_method, 2);
    EXPECT_EQ(force_at_depth(two, start_.place, 1), force_at_depth(model_, start_.place, 1));
}

TEST_F(LayOut, force_grows_with_depth_and_the_model_forgets_the_press) {
    const double shallow = force_at_depth(model_, start_.place, 1);
    const double deep = force_at_depth(model_, start_.place, 2);
    EXPECT_GT(shallow, 0);
    EXPECT_GT(deep, 1.5 * shallow);
    EXPECT_EQ(force_at_depth(model_, start_.place, 1), shallow);
}

}  // namespace
}  // namespace palpate
