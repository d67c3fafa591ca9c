// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <gtest/gtest.h>

#include "runtime/training/goals.hpp"

namespace palpate {
namespace {

using namespace training;
using Eigen::Vector3d;

Exercise exercise_of(Task task, std::vector<Vector3d> places) {
    return {.name = "x",
            .title = "",
            .instruction = "",
            .task = task,
            .time_limit = 0,
            .least_force = 0.1,
            .most_force = 1,
            .tolerance = 2,
            .hold = 0.5,
            .places = std::move(places),
            .region = ""};
}

// For `seconds`, in ticks of a millisecond.
void stay(const Exercise& exercise, Goals& goals, double seconds, double force, const Vector3d& place) {
    for (double t = 0; t < seconds - 1e-9; t += 0.001)
        follow(exercise,
               {.duration = 0.001,
                .force = force,
                .tool = place,
                .touched = force > 0 ? std::optional(place) : std::nullopt},
               goals);
}

// With what a forceps holds of the tissue at rest.
void hold(const Exercise& exercise, Goals& goals, double seconds, const Vector3d& tool,
          std::optional<Vector3d> held, double force = 0.5) {
    for (double t = 0; t < seconds - 1e-9; t += 0.001)
        follow(exercise, {.duration = 0.001, .force = held ? force : 0, .tool = tool, .touched = held},
               goals);
}

TEST(Goals, tissue_is_retracted_once_it_has_been_kept_there_and_let_go) {
    const Exercise exercise = exercise_of(Task::retract, {{0, 0, 4}, {0, 0, 0}, {0, 0, 5}});
    Goals goals;
    hold(exercise, goals, 0.6, {0, 0, 5}, std::nullopt);
    EXPECT_EQ(goals.reached, 0U);  // there, with nothing
    hold(exercise, goals, 0.6, {0, 0, 5}, Vector3d(9, 0, 0));
    EXPECT_EQ(goals.reached, 0U);  // with other tissue
    hold(exercise, goals, 0.3, {0, 0, 4}, Vector3d(0, 0, 1));
    hold(exercise, goals, 0.1, {0, 0, 1}, Vector3d(0, 0, 1));
    hold(exercise, goals, 0.3, {0, 0, 4}, Vector3d(0, 0, 1));
    EXPECT_EQ(goals.reached, 0U);  // not for long enough at once
    hold(exercise, goals, 0.3, {0, 0, 4}, Vector3d(0, 0, 1));
    EXPECT_EQ(goals.reached, 1U);
    EXPECT_DOUBLE_EQ(goals.share, 0.5);
    EXPECT_DOUBLE_EQ(goals.errors, 1);
    EXPECT_EQ(goals.misses, 0U);
    hold(exercise, goals, 1, {0, 0, 1}, Vector3d(0, 0, 1));
    EXPECT_FALSE(goals.reached_all);
    hold(exercise, goals, 0.01, {0, 0, 5}, std::nullopt);
    EXPECT_TRUE(goals.reached_all);
}

TEST(Goals, tissue_that_slips_out_while_it_is_drawn_is_a_miss) {
    const Exercise exercise = exercise_of(Task::retract, {{0, 0, 4}, {0, 0, 0}, {0, 0, 5}});
    Goals goals;
    for (int slip = 1; slip <= 2; ++slip) {
        hold(exercise, goals, 0.1, {0, 0, 1}, Vector3d(0, 0, 0));
        hold(exercise, goals, 0.1, {0, 0, 4}, Vector3d(0, 0, 0));
        hold(exercise, goals, 0.2, {0, 0, 5}, slip == 1 ? std::nullopt : std::optional(Vector3d(0, 0, 6)));
        EXPECT_EQ(goals.misses, static_cast<std::size_t>(slip));
    }
    // Given back where it was is none.
    hold(exercise, goals, 0.1, {0, 0, 4}, Vector3d(0, 0, 0));
    hold(exercise, goals, 0.1, {0, 0, 1}, Vector3d(0, 0, 0));
    hold(exercise, goals, 0.1, {0, 0, 1}, std::nullopt);
    EXPECT_EQ(goals.misses, 2U);
}

// A fault takes the force away though the jaws are closed.
TEST(Goals, tissue_is_not_let_go_of_while_a_fault_takes_the_force_away) {
    const Exercise exercise = exercise_of(Task::retract, {{0, 0, 4}, {0, 0, 0}, {0, 0, 5}});
    Goals goals;
    const auto lose_force = [&] {
        for (int tick = 0; tick < 600; ++tick)
            follow(exercise, {.duration = 0.001, .tool = {0, 0, 4}, .force_is_the_tissues = false}, goals);
    };
    hold(exercise, goals, 0.1, {0, 0, 1}, Vector3d(0, 0, 1));
    hold(exercise, goals, 0.3, {0, 0, 4}, Vector3d(0, 0, 1));
    lose_force();
    EXPECT_EQ(goals.misses, 0U);
    EXPECT_EQ(goals.reached, 0U);
    hold(exercise, goals, 0.3, {0, 0, 4}, Vector3d(0, 0, 1));
    EXPECT_EQ(goals.reached, 1U);  // what was kept before counts
    lose_force();
    EXPECT_FALSE(goals.reached_all);
    hold(exercise, goals, 0.01, {0, 0, 4}, std::nullopt);
    EXPECT_TRUE(goals.reached_all);
    EXPECT_EQ(goals.misses, 0U);
}

TEST(Goals, marks_are_reached_in_their_order_after_being_held) {
    const Exercise exercise = exercise_of(Task::touch, {{0, 0, 0}, {20, 0, 0}});
    Goals goals;
    stay(exercise, goals, 0.4, 0.5, {1, 0, 0});
    stay(exercise, goals, 0.4, 0, {1, 0, 5});
    EXPECT_EQ(goals.reached, 0U);  // not long enough
    stay(exercise, goals, 0.6, 0.05, {1, 0, 0});
    EXPECT_EQ(goals.reached, 0U);  // not hard enough
    stay(exercise, goals, 0.6, 0.5, {1, 0, 0});
    EXPECT_EQ(goals.reached, 1U);
    EXPECT_DOUBLE_EQ(goals.share, 0.5);
    EXPECT_DOUBLE_EQ(goals.errors, 1);
    stay(exercise, goals, 0.1, 0, {1, 0, 5});
    stay(exercise, goals, 0.6, 0.5, {20, 1.9, 0});
    EXPECT_TRUE(goals.reached_all);
    EXPECT_EQ(goals.misses, 0U);
}

TEST(Goals, a_fault_while_a_mark_is_held_is_waited_for_and_gates_are_passed_in_it) {
    const Exercise touch = exercise_of(Task::touch, {{0, 0, 0}, {20, 0, 0}});
    Goals goals;
    stay(touch, goals, 0.3, 0.5, {1, 0, 0});
    follow(touch, {.duration = 0.001, .tool = {1, 0, 0}, .force_is_the_tissues = false}, goals);
    stay(touch, goals, 0.3, 0.5, {1, 0, 0});
    EXPECT_EQ(goals.reached, 1U);
    EXPECT_EQ(goals.misses, 0U);
    const Exercise guide = exercise_of(Task::guide, {{0, 0, 0}, {20, 0, 0}});
    Goals passed;
    follow(guide, {.duration = 0.001, .tool = {0, 0, 0}, .force_is_the_tissues = false}, passed);
    EXPECT_EQ(passed.reached, 1U);
}

TEST(Goals, a_press_beside_the_mark_is_one_miss) {
    const Exercise exercise = exercise_of(Task::touch, {{0, 0, 0}, {20, 0, 0}});
    Goals goals;
    for (int i = 0; i < 2; ++i) {
        stay(exercise, goals, 0.7, 0.5, {10, 0, 0});
        stay(exercise, goals, 0.1, 0, {10, 0, 5});
    }
    EXPECT_EQ(goals.misses, 2U);
    EXPECT_EQ(goals.reached, 0U);
    stay(exercise, goals, 0.7, 0.5, {20, 0, 0});  // not yet its turn
    EXPECT_EQ(goals.reached, 0U);
}

TEST(Goals, a_mark_beside_the_hidden_place_counts_less_the_farther_it_is) {
    const Exercise exercise = exercise_of(Task::find, {{0, 0, 0}});
    for (const auto& [distance, share, misses] :
         {std::tuple(1.5, 1.0, 0U), std::tuple(4.0, 0.5, 1U), std::tuple(6.5, 0.0, 1U)}) {
        Goals goals;
        mark(exercise, goals);
        EXPECT_FALSE(goals.reached_all) << "nothing has been touched";
        stay(exercise, goals, 0.1, 0.5, {distance, 0, 0});
        stay(exercise, goals, 0.1, 0, {30, 0, 9});
        mark(exercise, goals);
        EXPECT_TRUE(goals.reached_all);
        EXPECT_DOUBLE_EQ(goals.share, share);
        EXPECT_EQ(goals.misses, misses);
        EXPECT_DOUBLE_EQ(goals.errors, distance);
    }
}

TEST(Goals, marks_of_a_border_err_by_their_distance_from_the_outline_until_the_answer) {
    Exercise exercise = exercise_of(Task::find, {{5, 5, 0}});
    exercise.outline = {{0, 0, 0}, {10, 0, 0}, {10, 10, 0}, {0, 10, 0}};
    Goals goals;
    mark_border(exercise, goals);
    EXPECT_TRUE(std::isnan(border_error(exercise, goals))) << "nothing has been touched";
    for (const Vector3d& place : {Vector3d(5, -1, 0), Vector3d(7, 5, 0), Vector3d(0, 5, 2)}) {
        stay(exercise, goals, 0.1, 0.5, place);
        mark_border(exercise, goals);
    }
    EXPECT_DOUBLE_EQ(border_error(exercise, goals), (1 + 3 + 2) / 3.0);
    EXPECT_FALSE(goals.reached_all);
    stay(exercise, goals, 0.1, 0.5, {5, 5, 0});
    mark(exercise, goals);
    mark_border(exercise, goals);
    EXPECT_EQ(goals.border.size(), 3U);
    EXPECT_EQ(goals.share, 1) << "the border does not change the answer";
}

TEST(Goals, gates_are_passed_in_their_order_and_pain_is_counted_once_each_time) {
    const Exercise exercise = exercise_of(Task::guide, {{0, 0, 0}, {10, 0, 0}, {20, 0, 0}});
    Goals goals;
    stay(exercise, goals, 0.01, 0, {10, 0, 0});
    EXPECT_EQ(goals.reached, 0U);
    stay(exercise, goals, 0.01, 0, {0, 1, 0});
    EXPECT_EQ(goals.share, 0) << "it begins there";
    stay(exercise, goals, 0.1, 1.5, {5, 0, 0});
    stay(exercise, goals, 0.1, 0.2, {5, 0, 0});
    stay(exercise, goals, 0.1, 1.5, {5, 0, 0});
    EXPECT_EQ(goals.misses, 2U);
    stay(exercise, goals, 0.01, 0, {10, 0, 0});
    EXPECT_EQ(goals.share, 0.5);
    stay(exercise, goals, 0.01, 0, {20, 0, 1});
    EXPECT_TRUE(goals.reached_all);
    EXPECT_NEAR(goals.errors, 1, 1e-12) << "of the first; the second was met, the last ends it";
    EXPECT_EQ(goals.error_count, 2U);
}

TEST(Goals, a_gate_is_as_far_as_the_tool_came_to_its_middle_before_the_next) {
    const Exercise exercise = exercise_of(Task::guide, {{0, 0, 0}, {10, 0, 0}, {20, 0, 0}});
    Goals goals;
    for (double x = -5; x < 25 && !goals.reached_all; x += 0.1) stay(exercise, goals, 0.001, 0, {x, 0.5, 0});
    EXPECT_TRUE(goals.reached_all);
    EXPECT_NEAR(goals.errors / static_cast<double>(goals.error_count), 0.5, 0.01);
}

TEST(Goals, a_line_is_followed_from_its_beginning_and_cannot_be_cut_short) {
    const Exercise exercise = exercise_of(Task::trace, {{0, 0, 0}, {10, 0, 0}, {20, 0, 0}, {30, 0, 0}});
    Goals goals;
    stay(exercise, goals, 0.1, 0.5, {15, 0, 0});
    EXPECT_EQ(goals.share, 0);
    EXPECT_EQ(goals.misses, 0U);  // not begun
    for (double x = 0; x < 15; x += 0.1) stay(exercise, goals, 0.01, 0.5, {x, 1, 0});
    EXPECT_NEAR(goals.share, 0.5, 0.01);
    for (double x = 15; x < 20; x += 0.1) stay(exercise, goals, 0.01, 0.5, {x, 3, 0});
    EXPECT_EQ(goals.misses, 1U);
    EXPECT_NEAR(goals.share, 0.5, 0.01);
    for (double x = 15; x < 28.5; x += 0.1) stay(exercise, goals, 0.01, 0.5, {x, 0, 0});
    EXPECT_TRUE(goals.reached_all);
    EXPECT_EQ(goals.share, 1);
}

}  // namespace
}  // namespace palpate
