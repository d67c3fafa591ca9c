// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "runtime/training/lesson.hpp"
#include "tests/formats/sample_case.hpp"

namespace palpate {
namespace {

using namespace training;

class LessonTest : public ::testing::Test {
  protected:
    static Exercise exercise(const std::string& name, Task task) {
        return {.name = name,
                .title = name,
                .instruction = "",
                .task = task,
                .time_limit = 10,
                .least_force = 0.1,
                .most_force = 1,
                .tolerance = 2,
                .hold = 0.5,
                .places = {Eigen::Vector3d::Zero()},
                .region = ""};
    }
    void let_pass(double seconds, std::uint32_t buttons = 0, double force = 0) {
        for (double t = 0; t < seconds - 1e-9; t += 0.01) {
            TickResult tick{};
            tick.time = time_ += 0.01;
            tick.buttons = buttons;
            tick.force = {force, 0, 0};
            tick.contact_count = force > 0 ? 1 : 0;
            tick.contacts[0] = {.body = 1, .vertices = {0, -1, -1}, .weights = {1, 0, 0}, .force = 1};
            lesson_.take(tick);
        }
    }
    const Case case_ = sample::sample_case();
    double time_ = 0;
    std::vector<Ending> endings_;
    Lesson lesson_{{exercise("touch", Task::touch), exercise("find", Task::find)},
                   case_,
                   3,
                   [this](const Attempt& attempt) { endings_.push_back(attempt.ending()); }};
};

TEST_F(LessonTest, goes_from_the_start_page_through_a_countdown_to_a_result_and_back) {
    EXPECT_EQ(lesson_.phase(), Phase::choosing);
    lesson_.press("7");
    EXPECT_EQ(lesson_.phase(), Phase::choosing);
    lesson_.press("1");
    EXPECT_EQ(lesson_.phase(), Phase::counting_down);
    let_pass(2.5);
    EXPECT_EQ(lesson_.phase(), Phase::counting_down);
    let_pass(0.7);
    EXPECT_EQ(lesson_.phase(), Phase::doing);
    let_pass(12);
    EXPECT_EQ(lesson_.phase(), Phase::looking_back);
    EXPECT_EQ(endings_, std::vector{Ending::time_is_up});
    lesson_.press("return");
    EXPECT_EQ(lesson_.phase(), Phase::counting_down);
    lesson_.press("backspace");
    EXPECT_EQ(lesson_.phase(), Phase::choosing);
    lesson_.press("backspace");
    EXPECT_EQ(lesson_.phase(), Phase::away);
    lesson_.press("backspace");
    EXPECT_EQ(lesson_.phase(), Phase::choosing);
}

TEST_F(LessonTest, a_pause_stops_the_clock_and_e_ends) {
    lesson_.choose(0);
    lesson_.press("return");
    let_pass(1);
    lesson_.press("space");
    let_pass(30);
    EXPECT_TRUE(lesson_.attempt()->paused());
    EXPECT_NEAR(lesson_.attempt()->time(), 1, 0.02);
    lesson_.press("space");
    let_pass(1);
    lesson_.press("e");
    EXPECT_EQ(endings_, std::vector{Ending::ended});
    EXPECT_NEAR(lesson_.attempt()->time(), 2, 0.03);
}

TEST_F(LessonTest, anew_keeps_what_was_begun_and_counts_down_again) {
    lesson_.choose(0);
    lesson_.press("return");
    let_pass(1);
    lesson_.press("n");
    EXPECT_EQ(endings_, std::vector{Ending::ended});
    EXPECT_EQ(lesson_.phase(), Phase::counting_down);
}

TEST_F(LessonTest, key_or_device_button_answer_a_search_after_a_touch) {
    for (const bool by_key : {true, false}) {
        lesson_.choose(1);
        lesson_.press("return");
        let_pass(0.1);
        lesson_.press("m");
        EXPECT_EQ(lesson_.phase(), Phase::doing);
        let_pass(0.1, 0, 0.5);
        if (by_key)
            lesson_.press("m");
        else
            let_pass(0.1, 1);
        EXPECT_EQ(lesson_.phase(), Phase::looking_back) << by_key;
        EXPECT_EQ(endings_.back(), Ending::found);
    }
}

TEST_F(LessonTest, takes_exercises_that_are_made_on_the_way) {
    EXPECT_EQ(lesson_.put(exercise("free", Task::free)), 2U);
    EXPECT_EQ(lesson_.put(exercise("touch", Task::free)), 0U);
    EXPECT_EQ(lesson_.exercises().size(), 3U);
    lesson_.press("1");
    lesson_.press("return");
    EXPECT_EQ(lesson_.attempt()->exercise().task, Task::free);
}

TEST_F(LessonTest, k_sets_points_of_a_border_and_does_not_answer) {
    lesson_.choose(1);
    lesson_.press("return");
    let_pass(0.1, 0, 0.5);
    lesson_.press("k");
    lesson_.press("k");
    EXPECT_EQ(lesson_.phase(), Phase::doing);
    EXPECT_EQ(lesson_.attempt()->goals().border.size(), 2U);
}

TEST_F(LessonTest, a_closed_window_cuts_an_attempt_short_and_hands_it_out) {
    lesson_.close();
    EXPECT_TRUE(endings_.empty());
    lesson_.choose(0);
    lesson_.press("return");
    let_pass(1);
    lesson_.close();
    EXPECT_EQ(endings_, std::vector{Ending::cut_short});
}

}  // namespace
}  // namespace palpate
