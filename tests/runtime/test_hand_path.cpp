// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <fstream>
#include <functional>
#include <gtest/gtest.h>

#include "formats/model/errors.hpp"
#include "runtime/devices/hand_path.hpp"
#include "runtime/devices/simulated_device.hpp"

namespace palpate {
namespace {

using Eigen::Vector3d;

const TouchPoint target{.point = {1, 2, 3}, .normal = {0, 0, 1}, .tangent = {1, 0, 0}, .clearance = 2};

std::filesystem::path text_file(const std::string& text) {
    const auto path = std::filesystem::path(::testing::TempDir()) / "palpate_hand_path.txt";
    std::ofstream(path) << text;
    return path;
}

std::string refusal(const std::string& text) {
    try {
        read_hand_path(text_file(text));
    } catch (const InvalidInput& error) {
        return error.what();
    }
    return "";
}

TEST(HandPath, goes_straight_between_keys_and_rests_outside_them) {
    const HandPath path({{1, {0, 0, 0}}, {2, {2, 4, 6}}, {4, {2, 4, 7}}});
    EXPECT_EQ(path.at(0), Vector3d(0, 0, 0));
    EXPECT_EQ(path.at(1.5), Vector3d(1, 2, 3));
    EXPECT_EQ(path.at(3), Vector3d(2, 4, 6.5));
    EXPECT_EQ(path.at(9), Vector3d(2, 4, 7));
    EXPECT_EQ(path.duration(), 4);
}

TEST(HandPath, refuses_no_keys_times_that_do_not_rise_and_numbers_that_are_none) {
    EXPECT_THROW(HandPath({}), InvalidInput);
    EXPECT_THROW(HandPath({{0, {0, 0, 0}}, {0, {1, 1, 1}}}), InvalidInput);
    EXPECT_THROW(HandPath({{0, {0, std::nan(""), 0}}}), InvalidInput);
}

TEST(PressPath, starts_clear_goes_to_depth_at_speed_and_returns) {
    const ScriptSettings settings{.tool_radius = 1, .depth = 3, .speed = 20, .hold_s = 0.5, .seconds = 2};
    const HandPath path = press_path(target, settings);
    EXPECT_NEAR((path.at(0) - Vector3d(1, 2, 3 + 1 + 2)).norm(), 0, 1e-12);
    EXPECT_NEAR((path.at(0.25) - Vector3d(1, 2, 3 + 1 - 3)).norm(), 0, 1e-12);  // 5 mm at 20 mm/s
    EXPECT_NEAR((path.at(0.75) - path.at(0.25)).norm(), 0, 1e-12);
    EXPECT_NEAR((path.at(1.0) - path.at(0)).norm(), 0, 1e-12);
    EXPECT_GE(path.duration(), 2);
    EXPECT_NEAR((path.at(99) - path.at(0)).norm(), 0, 1e-12);
}

TEST(SlidePath, stays_at_depth_goes_to_both_sides_and_leaves) {
    const ScriptSettings settings{
        .tool_radius = 1, .depth = 1, .speed = 10, .hold_s = 0, .slide_length = 4, .seconds = 4};
    const HandPath path = slide_path(target, settings);
    double low = 0, high = 0;
    for (double t = 0.31; t < 1.8; t += 0.01) {
        EXPECT_NEAR(path.at(t).z(), 3, 1e-12);
        low = std::min(low, path.at(t).x() - 1);
        high = std::max(high, path.at(t).x() - 1);
        EXPECT_LE((path.at(t + 0.001) - path.at(t)).norm(), 0.01 + 1e-12);
    }
    EXPECT_NEAR(low, -4, 0.11);
    EXPECT_NEAR(high, 4, 0.11);
    EXPECT_NEAR(path.at(99).z(), 6, 1e-12);
}

TEST(RandomPath, stays_within_depth_length_and_speed_and_leaves_at_the_end) {
    const ScriptSettings settings{
        .tool_radius = 1, .depth = 2, .speed = 50, .hold_s = 0.1, .slide_length = 3, .seconds = 20};
    const HandPath path = random_path(target, settings, 5);
    double deepest = 9, highest = 0, farthest = 0, fastest = 0;
    for (double t = 0; t < path.duration(); t += 1e-3) {
        const Vector3d p = path.at(t) - target.point;
        deepest = std::min(deepest, p.z());
        highest = std::max(highest, p.z());
        farthest = std::max(farthest, p.head<2>().norm());
        fastest = std::max(fastest, (path.at(t + 1e-3) - path.at(t)).norm() * 1e3);
    }
    EXPECT_GE(deepest, 1 - 2 - 1e-9);
    EXPECT_LT(deepest, 1 - 1.8);
    EXPECT_NEAR(highest, 1 + 2, 1e-9);
    EXPECT_LE(farthest, 3 + 1e-9);
    EXPECT_GT(farthest, 2.7);
    EXPECT_LE(fastest, 50 + 1e-6);
    EXPECT_GT(fastest, 45);
    EXPECT_GE(path.duration(), 20);
    EXPECT_EQ(path.at(99), path.at(0));
}

TEST(RandomPath, the_seed_decides) {
    const HandPath a = random_path(target, {}, 1), b = random_path(target, {}, 1),
                   c = random_path(target, {}, 2);
    EXPECT_EQ(a.at(1.234), b.at(1.234));
    EXPECT_NE(a.at(1.234), c.at(1.234));
}

TEST(Scripts, refuse_settings_that_make_no_motion) {
    const auto refused = [](const std::function<void(ScriptSettings&)>& spoil) {
        ScriptSettings settings;
        spoil(settings);
        EXPECT_THROW(press_path(target, settings), UsageError);
        EXPECT_THROW(slide_path(target, settings), UsageError);
        EXPECT_THROW(random_path(target, settings, 1), UsageError);
    };
    refused([](ScriptSettings& s) { s.speed = 0; });
    refused([](ScriptSettings& s) { s.depth = -1; });
    refused([](ScriptSettings& s) { s.seconds = std::nan(""); });
}

TEST(ReadHandPath, takes_a_position_per_millisecond_or_times) {
    const HandPath rows = read_hand_path(text_file("# mm\n1 2 3\n\n1, 2, 5 # second\n"));
    EXPECT_EQ(rows.at(0.0005), Vector3d(1, 2, 4));
    EXPECT_EQ(rows.duration(), 0.001);
    const HandPath timed = read_hand_path(text_file("0 1 2 3\n2,1,2,5\n"));
    EXPECT_EQ(timed.at(1), Vector3d(1, 2, 4));
}

TEST(ReadHandPath, names_file_and_line_of_what_is_wrong) {
    EXPECT_NE(refusal("1 2 3\n1 x 3\n").find("palpate_hand_path.txt, line 2"), std::string::npos);
    EXPECT_NE(refusal("1 2 3\n1 2 3 4\n").find("line 2: 4 numbers"), std::string::npos);
    EXPECT_NE(refusal("1 2\n").find("line 1: 2 numbers"), std::string::npos);
    EXPECT_NE(refusal("0 1 2 3\n0 1 2 3\n").find("line 2: time"), std::string::npos);
    EXPECT_NE(refusal("1 2 nan\n").find("line 1"), std::string::npos);
    EXPECT_NE(refusal("# nothing\n").find("no positions"), std::string::npos);
    EXPECT_THROW(read_hand_path("/nowhere/path.txt"), InvalidInput);
}

TEST(SimulatedDevice, is_where_its_path_says) {
    SimulatedDevice device(HandPath({{0, {0, 0, 0}}, {1, {1, 2, 3}}}),
                           {.max_force = 3, .max_stiffness = 0.5});
    const DeviceState state = device.read(0.5);
    EXPECT_EQ(state.position, (std::array<double, 3>{0.5, 1, 1.5}));
    EXPECT_EQ(state.faults, no_fault);
    EXPECT_EQ(device.limits().max_force, 3);
}

}  // namespace
}  // namespace palpate
