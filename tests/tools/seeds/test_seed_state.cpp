// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "formats/model/errors.hpp"
#include "tools/seeds/seed_state.hpp"

namespace palpate {
namespace {

using namespace seeds;
using Eigen::Vector3d;

const ImageGrid grid{.size = {20, 30, 40}, .spacing = {1, 2, 3}, .origin = {-5, 0, 100}};

TEST(SeedState, starts_with_the_first_structure_and_the_background_under_key_0) {
    const SeedState state = start_state(grid, {"liver", "tumour"}, {});
    EXPECT_EQ(state.labels, (std::vector<std::string>{"background", "liver", "tumour"}));
    EXPECT_EQ(state.active, 1U);
    EXPECT_EQ(state.crosshair, (std::array<std::int32_t, 3>{10, 15, 20}));
    EXPECT_FALSE(unsaved(state));
}

TEST(SeedState, takes_labels_and_place_from_seeds_read_earlier) {
    const std::vector<imaging::Seed> seeds{{"background", {0, 0, 100}}, {"spleen", {-3, 8, 109}}};
    const SeedState state = start_state(grid, {"liver"}, seeds);
    EXPECT_EQ(state.labels, (std::vector<std::string>{"background", "liver", "spleen"}));
    EXPECT_EQ(state.crosshair, (std::array<std::int32_t, 3>{2, 4, 3}));
    EXPECT_FALSE(unsaved(state));
}

TEST(SeedState, refuses_more_structures_than_number_keys) {
    std::vector<std::string> labels;
    for (int i = 0; i < 9; ++i) labels.push_back("l" + std::to_string(i));
    EXPECT_EQ(start_state(grid, labels, {}).labels.size(), 10U);
    labels.push_back("one more");
    EXPECT_THROW(start_state(grid, labels, {}), UsageError);
}

TEST(SeedState, a_seed_is_of_the_active_label_and_takes_the_crosshair_along) {
    SeedState state = start_state(grid, {"liver"}, {});
    place_seed(state, grid, {4.2, 7, 9});
    EXPECT_TRUE(choose_label(state, 0));
    EXPECT_FALSE(choose_label(state, 2));
    place_seed(state, grid, {1, 2, 3});
    ASSERT_EQ(state.seeds.size(), 2U);
    EXPECT_EQ(state.seeds[0].label, "liver");
    EXPECT_TRUE(state.seeds[0].p_P.isApprox(Vector3d(-0.8, 14, 127)));
    EXPECT_EQ(state.seeds[1].label, "background");
    EXPECT_EQ(state.crosshair, (std::array<std::int32_t, 3>{1, 2, 3}));
}

TEST(SeedState, removes_the_nearest_seed_within_reach_only) {
    SeedState state = start_state(grid, {"liver"}, {});
    place_seed(state, grid, {2, 2, 2});
    place_seed(state, grid, {10, 10, 10});
    EXPECT_FALSE(remove_nearest(state, grid.point_of({10, 10, 12}), 5.9));  // 6 mm away
    EXPECT_TRUE(remove_nearest(state, grid.point_of({10, 10, 12}), 6.1));
    ASSERT_EQ(state.seeds.size(), 1U);
    EXPECT_TRUE(state.seeds[0].p_P.isApprox(grid.point_of({2, 2, 2})));
    EXPECT_TRUE(remove_last(state));
    EXPECT_FALSE(remove_last(state));
    EXPECT_FALSE(remove_nearest(state, {0, 0, 0}, 1e9));
}

TEST(SeedState, undo_takes_back_each_change_and_knows_what_was_saved) {
    SeedState state = start_state(grid, {"liver"}, {});
    place_seed(state, grid, {2, 2, 2});
    state.saved = state.seeds;
    place_seed(state, grid, {3, 3, 3});
    remove_last(state);
    EXPECT_FALSE(unsaved(state));
    EXPECT_TRUE(undo(state));
    EXPECT_EQ(state.seeds.size(), 2U);
    EXPECT_TRUE(unsaved(state));
    EXPECT_TRUE(undo(state));
    EXPECT_FALSE(unsaved(state));
    EXPECT_TRUE(undo(state));
    EXPECT_TRUE(state.seeds.empty());
    EXPECT_FALSE(undo(state));
}

TEST(SeedState, scrolling_and_the_crosshair_stay_within_the_volume) {
    SeedState state = start_state(grid, {"liver"}, {});
    const SliceView axial = slice_views(grid)[0];
    scroll(state, grid, axial, 3);
    EXPECT_EQ(state.crosshair[2], 23);
    scroll(state, grid, axial, 100);
    EXPECT_EQ(state.crosshair[2], 39);
    move_crosshair(state, grid, {-4, 99, 7.6});
    EXPECT_EQ(state.crosshair, (std::array<std::int32_t, 3>{0, 29, 8}));
}

}  // namespace
}  // namespace palpate
