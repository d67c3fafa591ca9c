// SPDX-License-Identifier: Apache-2.0
// What is read off the window beside the scene: force, health, what can be felt.
#include <gtest/gtest.h>
#include <vtkNew.h>

#include "formats/records/fault.hpp"
#include "formats/records/tick_result.hpp"
#include "runtime/visual/readings/felt_text.hpp"
#include "runtime/visual/readings/force_colour.hpp"
#include "runtime/visual/readings/force_strip.hpp"
#include "runtime/visual/readings/health.hpp"
#include "tests/runtime/visual/luminance.hpp"

namespace palpate {
namespace {

using namespace std::chrono_literals;
using visual::force_colour;
using visual::ForceStrip;
using visual::Health;
using visual::health_of;
using visual::health_text;
using visual::VisualFrame;

TEST(ForceColour, is_lighter_the_larger_the_force) {
    for (double share = 0; share < 1; share += 0.05)
        EXPECT_GT(luminance(force_colour(share + 0.05)), luminance(force_colour(share)) + 2) << share;
    EXPECT_EQ(force_colour(7), force_colour(1)) << "beyond the largest";
    EXPECT_EQ(force_colour(-1), force_colour(0));
}

TEST(ForceStrip, keeps_least_and_largest_force_of_each_tenth_of_a_second) {
    vtkNew<vtkRenderer> renderer;
    ForceStrip strip(renderer);
    const auto start = ForceStrip::Time{} + 100s;
    strip.add(start, {0, 0});
    strip.add(start + 40ms, {0.5, 2});  // a tap between two frames
    strip.add(start + 80ms, {1, 1});
    EXPECT_EQ(strip.columns().back(), Eigen::Vector2d(0, 0)) << "it goes on";
    strip.add(start + 120ms, {1, 1.5});
    EXPECT_EQ(strip.columns().back(), Eigen::Vector2d(0, 2));
    strip.add(start + 240ms, {1.2, 1.2});
    EXPECT_EQ(strip.columns().back(), Eigen::Vector2d(1, 1.5));
    EXPECT_EQ(strip.columns().rbegin()[1], Eigen::Vector2d(0, 2));
}

TEST(ForceStrip, keeps_time_where_frames_are_slow_and_forgets_what_is_old) {
    vtkNew<vtkRenderer> renderer;
    ForceStrip strip(renderer);
    auto now = ForceStrip::Time{} + 100s;
    strip.add(now, {3, 3});
    now += 350ms;
    strip.add(now, {3, 3});
    const auto& columns = strip.columns();
    EXPECT_EQ(columns.rbegin()[2], Eigen::Vector2d(3, 3));
    EXPECT_EQ(columns.rbegin()[3], Eigen::Vector2d(0, 0));
    const std::size_t count = columns.size();
    for (int frame = 0; frame < 400; ++frame) strip.add(now += 40ms, {1, 1});
    EXPECT_EQ(columns.size(), count);
    EXPECT_EQ(columns.front(), Eigen::Vector2d(1, 1));
    strip.add(now + 1h, {2, 2});
    EXPECT_EQ(columns.size(), count);
}

TEST(Health, says_the_worst_first_and_names_the_device) {
    VisualFrame frame;
    frame.device = "a device";
    frame.faults = servo_stopping;  // as at every end
    EXPECT_EQ(health_of(frame), Health::good);
    EXPECT_EQ(health_text(frame), "a device: force as computed");
    frame.statuses = force_limited;
    EXPECT_EQ(health_text(frame), "a device: force limited");
    frame.statuses = force_limited | contact_unsolved;
    EXPECT_EQ(health_of(frame), Health::limited);
    EXPECT_EQ(health_text(frame), "a device: force uncertain");
    frame.faults = motors_warm;
    EXPECT_EQ(health_of(frame), Health::no_force);
    EXPECT_EQ(health_text(frame), "a device: no force");
    const auto light = [](Health health) { return luminance(visual::health_colour(health)); };
    EXPECT_GT(light(Health::good), light(Health::limited) + 10);
    EXPECT_GT(light(Health::limited), light(Health::no_force) + 10);
}

TEST(FeltText, says_how_much_stiffer_a_region_feels_and_whether_this_device_tells_it) {
    DeformableBody body;
    EXPECT_EQ(visual::felt_text(body, 2, rendered_force), "") << "nobody has computed it";
    const FeltRegion lump{.region = 2, .stiffness = 0.13, .stiffness_without = 0.1, .variation = 0.2};
    body.feel = Feel{.tool_radius = 5, .depth = 3, .stiffness = {}, .regions = {lump}};
    EXPECT_EQ(visual::felt_text(body, 3, rendered_force), "") << "another region";
    EXPECT_EQ(visual::felt_text(body, 2, 0.06), "stiffer by 30 %, can be felt");
    EXPECT_EQ(visual::felt_text(body, 2, 0.26), "stiffer by 30 %, too weak for this device") << "0.09 N";
    body.feel->regions.front().variation = 0.4;
    EXPECT_EQ(visual::felt_text(body, 2, 0.06), "stiffer by 30 %, no more than tissue varies by around it");
    body.feel->regions.front() = {.region = 2, .stiffness = 0.09, .stiffness_without = 0.1};
    EXPECT_EQ(visual::felt_text(body, 2, 0.06), "softer by 10 %, too faint to feel");
}

}  // namespace
}  // namespace palpate
