// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <gtest/gtest.h>

#include "formats/model/arrays.hpp"
#include "runtime/training/attempt.hpp"
#include "runtime/training/touched_place.hpp"
#include "tests/formats/sample_case.hpp"

namespace palpate {
namespace {

using namespace training;
using Eigen::Vector3d;

class AttemptTest : public ::testing::Test {
  protected:
    Exercise exercise(Task task) const {
        return {.name = "x",
                .title = "",
                .instruction = "",
                .task = task,
                .time_limit = 10,
                .least_force = 0.1,
                .most_force = 1,
                .tolerance = 2,
                .hold = 0.5,
                .places = {vertex(0), vertex(1)},
                .region = ""};
    }
    const Vector3d& vertex(std::size_t i) const {
        return case_.deformable_bodies[0].boundary.surface.vertices[i];
    }
    // Ticks during which vertex `touched` is pressed with `force`.
    void press(Attempt& attempt, double seconds, double force, std::int32_t touched) {
        for (double t = 0; t < seconds - 1e-9; t += 0.001) attempt.add(next_tick(force, touched));
    }
    TickResult next_tick(double force, std::int32_t touched) {
        TickResult tick{};
        tick.time = time_ += 0.001;
        tick.force = {0, 0, force};
        tick.device_position = array_of(vertex(static_cast<std::size_t>(touched)));
        tick.contact_count = force > 0 ? 1 : 0;
        tick.contacts[0] = {.body = 1,
                            .vertices = {touched, -1, -1},
                            .weights = {1, 0, 0},
                            .force = static_cast<float>(force)};
        return tick;
    }
    const Case case_ = sample::sample_case();
    double time_ = 0;
};

TEST_F(AttemptTest, knows_which_place_of_the_tissue_is_touched) {
    TickResult tick = next_tick(1, 3);
    EXPECT_NEAR((*touched_place(case_, tick) - vertex(3)).norm(), 0, 1e-6);
    tick.contacts[1] = tick.contacts[0];
    tick.contacts[1].vertices[0] = 5;
    tick.contacts[1].force = 3;
    tick.contact_count = 2;
    EXPECT_NEAR((*touched_place(case_, tick) - (vertex(3) + 3 * vertex(5)) / 4).norm(), 0, 1e-6);
    tick.contacts[1].other_body = 0;  // a neighbour presses there, not the tool
    EXPECT_NEAR((*touched_place(case_, tick) - vertex(3)).norm(), 0, 1e-6);
    EXPECT_FALSE(touched_place(case_, next_tick(0, 3)));
}

TEST_F(AttemptTest, a_good_hand_gets_all_points_and_the_attempt_ends_by_itself) {
    Attempt attempt(exercise(Task::touch), case_);
    press(attempt, 0.6, 0.5, 0);
    press(attempt, 0.3, 0, 0);
    EXPECT_FALSE(attempt.over());
    press(attempt, 0.6, 0.5, 1);
    EXPECT_EQ(attempt.ending(), Ending::all_reached);
    const Metrics m = attempt.metrics();
    EXPECT_DOUBLE_EQ(m.score, 100);
    EXPECT_NEAR(m.time, 1.4, 0.01);
    EXPECT_NEAR(m.time_in_contact, 1.1, 0.01);
    EXPECT_NEAR(m.mean_force, 0.5, 1e-9);
    EXPECT_EQ(m.misses, 0);
    EXPECT_NEAR(m.path_length, (vertex(1) - vertex(0)).norm(), 1e-6);
    EXPECT_NEAR(m.economy_of_motion, 1, 1e-6);
}

TEST_F(AttemptTest, what_a_fault_takes_away_is_not_the_trainees_doing) {
    Attempt attempt(exercise(Task::touch), case_);
    press(attempt, 0.3, 0.5, 0);
    TickResult late = next_tick(0, 0);
    late.faults = tick_late;
    attempt.add(late);
    TickResult returning = next_tick(0.05, 0);
    returning.status = coming_back;
    attempt.add(returning);
    press(attempt, 0.3, 0.5, 0);
    press(attempt, 0.3, 0, 0);
    press(attempt, 0.6, 0.5, 1);
    EXPECT_EQ(attempt.ending(), Ending::all_reached);
    EXPECT_EQ(attempt.metrics().misses, 0);
}

TEST_F(AttemptTest, a_rough_hand_loses_the_share_of_time_in_which_it_hurt) {
    Attempt attempt(exercise(Task::touch), case_);
    press(attempt, 0.3, 0.5, 0);
    press(attempt, 0.3, 3, 0);
    press(attempt, 0.1, 0, 0);
    press(attempt, 0.25, 3, 1);
    press(attempt, 0.3, 0.5, 1);
    ASSERT_EQ(attempt.ending(), Ending::all_reached);
    const Metrics m = attempt.metrics();
    EXPECT_NEAR(m.score, 100 * (1 - 0.55 / 1.1), 1);
    EXPECT_NEAR(m.time_above_limit, 0.55, 0.002);
    EXPECT_DOUBLE_EQ(m.peak_force, 3);
}

TEST_F(AttemptTest, an_idle_hand_gets_nothing_when_time_is_up) {
    Attempt attempt(exercise(Task::touch), case_);
    press(attempt, 11, 0, 0);
    EXPECT_EQ(attempt.ending(), Ending::time_is_up);
    const Metrics m = attempt.metrics();
    EXPECT_EQ(m.score, 0);
    EXPECT_NEAR(m.time, 10, 0.002);
    EXPECT_TRUE(std::isnan(m.economy_of_motion));
    EXPECT_TRUE(std::isnan(m.position_error));
}

TEST_F(AttemptTest, a_pause_does_not_count) {
    Attempt attempt(exercise(Task::touch), case_);
    press(attempt, 0.3, 0.5, 0);
    attempt.pause(true);
    press(attempt, 5, 3, 0);
    attempt.pause(false);
    press(attempt, 0.1, 0, 0);
    const Metrics m = attempt.metrics();
    EXPECT_NEAR(m.time, 0.4, 0.005);
    EXPECT_EQ(m.time_above_limit, 0);
    EXPECT_EQ(attempt.goals().reached, 0U);
}

TEST_F(AttemptTest, ticks_of_another_tool_and_after_the_end_do_not_count) {
    Attempt attempt(exercise(Task::find), case_);
    press(attempt, 0.2, 0.5, 0);
    TickResult other = next_tick(5, 1);
    other.tool = 1;
    attempt.add(other);
    attempt.mark_found();
    EXPECT_EQ(attempt.ending(), Ending::found);
    EXPECT_DOUBLE_EQ(attempt.metrics().score, 100);
    press(attempt, 0.2, 5, 1);
    attempt.end(Ending::cut_short);
    EXPECT_EQ(attempt.ending(), Ending::found);
    EXPECT_DOUBLE_EQ(attempt.metrics().peak_force, 0.5);
}

TEST_F(AttemptTest, an_answer_elsewhere_is_not_called_found) {
    Attempt attempt(exercise(Task::find), case_);
    press(attempt, 0.2, 0.5, 1);
    attempt.mark_found();
    ASSERT_GT((vertex(1) - vertex(0)).norm(), attempt.exercise().tolerance);
    EXPECT_EQ(attempt.ending(), Ending::not_found);
    EXPECT_EQ(attempt.metrics().misses, 1);
}

TEST_F(AttemptTest, a_free_one_has_no_score) {
    Attempt attempt(exercise(Task::free), case_);
    press(attempt, 0.2, 0.5, 0);
    attempt.end(Ending::ended);
    EXPECT_TRUE(std::isnan(attempt.metrics().score));
    EXPECT_GT(attempt.metrics().time_in_contact, 0.1);
}

}  // namespace
}  // namespace palpate
