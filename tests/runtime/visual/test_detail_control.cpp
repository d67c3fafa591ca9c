// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <functional>
#include <gtest/gtest.h>

#include "runtime/visual/detail/detail.hpp"
#include "runtime/visual/detail/detail_control.hpp"

namespace palpate {
namespace {

using visual::DetailControl;

// Draws for so long, a frame of each level taking what `cost` says (s), 60 a second at most.
void draw(DetailControl& control, double seconds, const std::function<double(int)>& cost) {
    for (double gone = 0; gone < seconds;) {
        const double frame = std::max(1.0 / 60, cost(control.level()));
        control.take(frame);
        gone += frame;
    }
}

TEST(DetailControl, fast_frames_keep_everything) {
    DetailControl control(4);
    draw(control, 60, [](int) { return 0.02; });
    EXPECT_EQ(control.level(), 4);
    EXPECT_EQ(control.changes(), 0);
}

TEST(DetailControl, steps_down_before_30_frames_are_lost) {
    DetailControl control(4);
    draw(control, 1, [](int level) { return level == 4 ? 1 / 31.0 : 0.028; });
    EXPECT_EQ(control.level(), 3);
}

TEST(DetailControl, finds_the_level_that_holds_30_frames_and_stays_there) {
    DetailControl control(6);
    draw(control, 10, [](int level) { return 0.012 * level; });
    EXPECT_EQ(control.level(), 2);
    draw(control, 600, [](int level) { return 0.012 * level; });
    EXPECT_EQ(control.level(), 2);
    EXPECT_LE(control.changes(), 6);
}

TEST(DetailControl, is_quickly_down_where_frames_are_far_too_slow) {
    DetailControl control(6);
    draw(control, 4, [](int level) { return 0.055 * level; });
    EXPECT_LE(control.level(), 2);
}

TEST(DetailControl, a_machine_that_is_never_fast_enough_ends_at_the_least_and_tries_no_more) {
    DetailControl control(3);
    draw(control, 300, [](int) { return 0.2; });
    EXPECT_EQ(control.level(), 1);
    EXPECT_LE(control.changes(), 2);
}

TEST(DetailControl, goes_up_again_once_there_is_room) {
    DetailControl control(4);
    draw(control, 10, [](int) { return 0.05; });
    EXPECT_EQ(control.level(), 1);
    draw(control, 60, [](int) { return 0.017; });
    EXPECT_EQ(control.level(), 4);
}

TEST(DetailControl, single_slow_frames_change_nothing) {
    DetailControl control(4);
    for (int i = 0; i < 3000; ++i) control.take(i % 7 == 0 ? 0.5 : 0.02);
    EXPECT_EQ(control.changes(), 0);
}

TEST(DetailControl, the_first_frames_which_make_shaders_do_not_count) {
    DetailControl control(2);
    control.take(3);
    control.take(1);
    draw(control, 10, [](int) { return 0.02; });
    EXPECT_EQ(control.changes(), 0);
}

TEST(DetailControl, tries_that_fail_are_made_less_and_less_often) {
    DetailControl control(4);
    const auto cost = [](int level) { return level == 4 ? 0.04 : 0.017; };
    draw(control, 60, cost);
    const auto in_the_first_minute = control.changes();
    draw(control, 540, cost);
    EXPECT_LE(in_the_first_minute, 11);
    EXPECT_LE(control.changes() - in_the_first_minute, 14);
}

TEST(DetailLevels, end_with_everything_and_leave_lines_enough_to_see) {
    for (const int height : {240, 720, 1080, 2160}) {
        const auto levels = visual::detail_levels(height, true);
        for (const visual::Detail& level : levels)
            EXPECT_TRUE(level.pixel == 1 || height / level.pixel >= 300);
        EXPECT_EQ(levels.back().pixel, 1);
        EXPECT_TRUE(levels.back().grain && levels.back().fine_bodies && levels.back().occlusion);
    }
    EXPECT_GT(visual::detail_levels(2160, true).front().pixel,
              visual::detail_levels(720, true).front().pixel);
}

TEST(DetailLevels, least_that_software_draws_has_no_pixels_blended) {
    const auto levels = visual::detail_levels(720, false);
    EXPECT_FALSE(levels.front().smooth);
    EXPECT_EQ(levels[1].pixel, levels.front().pixel);
    EXPECT_TRUE(
        std::all_of(levels.begin() + 1, levels.end(), [](const auto& level) { return level.smooth; }));
    EXPECT_TRUE(visual::detail_levels(240, false).front().smooth);  // nothing lies between its pixels
}

TEST(DetailLevels, of_a_graphics_card_are_all_blended_and_of_a_machine_without_have_no_occlusion) {
    EXPECT_TRUE(std::ranges::all_of(visual::detail_levels(720, true), &visual::Detail::smooth));
    EXPECT_FALSE(std::ranges::any_of(visual::detail_levels(720, false), &visual::Detail::occlusion));
}

}  // namespace
}  // namespace palpate
