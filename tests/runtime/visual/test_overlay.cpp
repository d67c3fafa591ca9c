// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "formats/records/tick_result.hpp"
#include "runtime/visual/cautions_text.hpp"
#include "runtime/visual/overlay.hpp"

namespace palpate {
namespace {

using visual::cautions_text;
using visual::notice_of;
using visual::VisualFrame;

TEST(Overlay, says_nothing_of_ordinary_ticks) {
    VisualFrame frame;
    EXPECT_EQ(notice_of(frame), "");
    frame.statuses = force_limited | rate_limited | coming_back;
    EXPECT_EQ(notice_of(frame), "");
}

TEST(Overlay, says_what_a_user_must_know_of_faults_and_statuses) {
    VisualFrame frame;
    frame.faults = motors_warm | servo_stopping;
    frame.statuses = starts_inside | contact_unsolved | force_limited;
    EXPECT_EQ(notice_of(frame),
              "force taken away: the device's motors are too warm\nlet them cool down\n"
              "contacts contradict each other, as in a wedge: no body gives way\n"
              "a tool is in a body, which is not felt until the tool has been clear of it");
}

TEST(Overlay, names_the_bodies_that_are_not_linear) {
    VisualFrame frame;
    EXPECT_EQ(visual::title_of("liver", frame), "liver");
    frame.deforming_far = {"liver", "gallbladder"};
    EXPECT_EQ(visual::title_of("liver", frame), "liver, large deformation: liver, gallbladder");
}

TEST(Overlay, breaks_cautions_between_words_and_counts_characters_not_bytes) {
    EXPECT_EQ(cautions_text({}, 12), "");
    EXPECT_EQ(cautions_text(std::vector<std::string>{"‘äöü’ is made up", "no source"}, 13),
              "\u2022 ‘äöü’ is made\n   up\n\u2022 no source");
    EXPECT_EQ(cautions_text(std::vector<std::string>{"a wordlongerthanthat b"}, 6),
              "\u2022 a\n   wordlongerthanthat\n   b");
}

TEST(Overlay, grows_with_the_window_and_stays_readable_in_a_small_one) {
    EXPECT_EQ(visual::display_scale(1280, 720), 1);
    EXPECT_EQ(visual::display_scale(3840, 2160), 3);
    EXPECT_EQ(visual::display_scale(2560, 720), 1) << "a wide window is no higher";
    EXPECT_EQ(visual::display_scale(1280, 1440), 1) << "nor has a high one room beside";
    EXPECT_GT(14 * visual::display_scale(320, 240), 9) << "points";
}

TEST(Overlay, tells_the_torque_of_what_turns_alone) {
    VisualFrame frame;
    frame.depth = 2;
    frame.torque = {3, 4, 0};
    EXPECT_EQ(visual::figures_of(frame, 30, {}), "depth 2.0 mm\n0 ticks/s, 0 overruns\n30 frames/s");
    frame.tool_orientation.setIdentity();
    EXPECT_EQ(visual::figures_of(frame, 30, {.level = 1, .levels = 4}),
              "depth 2.0 mm\ntorque 5.0 N mm\n0 ticks/s, 0 overruns\n30 frames/s, detail 1 of 4");
}

}  // namespace
}  // namespace palpate
