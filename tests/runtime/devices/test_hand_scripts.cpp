// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <numbers>
#include <vector>

#include "formats/model/errors.hpp"
#include "runtime/devices/hand_path.hpp"

namespace palpate {
namespace {

using namespace devices;
using Eigen::Vector3d;

const TouchPoint target{.point = {1, 2, 3}, .normal = {0, 0, 1}, .tangent = {1, 0, 0}, .clearance = 2};

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

TEST(RandomPath, turns_a_tool_as_far_as_it_is_asked_to_and_no_faster_than_a_wrist) {
    const ScriptSettings settings{.speed = 50, .hold_s = 0.1, .seconds = 60, .turn = 0.5};
    const HandPath path = random_path(target, settings, 5);
    double most_tilt = 0, most_turn = 0, fastest = 0;
    for (double t = 0; t < path.duration(); t += 1e-3) {
        const Eigen::Quaterniond q = path.orientation_at(t);
        ASSERT_NEAR(q.norm(), 1, 1e-12);
        most_tilt = std::max(most_tilt, std::acos(std::min(1.0, (q * Vector3d::UnitZ()).dot(target.normal))));
        most_turn = std::max(most_turn, q.angularDistance(path.orientation_at(0)));
        fastest = std::max(fastest, q.angularDistance(path.orientation_at(t + 1e-3)) * 1e3);
    }
    EXPECT_LE(most_tilt, 0.5 + 1e-9);
    EXPECT_GT(most_tilt, 0.45);
    EXPECT_GT(most_turn, 0.55);  // about its shaft too
    EXPECT_LE(fastest, 1.5 + 1e-6);
    EXPECT_GT(fastest, 1.4);
    EXPECT_EQ(path.orientation_at(0) * Vector3d::UnitZ(), target.normal);
    EXPECT_EQ(random_path(target, {}, 5).orientation_at(1).norm(), 0);
}

TEST(RandomPath, the_seed_decides) {
    const HandPath a = random_path(target, {}, 1), b = random_path(target, {}, 1),
                   c = random_path(target, {}, 2);
    EXPECT_EQ(a.at(1.234), b.at(1.234));
    EXPECT_NE(a.at(1.234), c.at(1.234));
}

TEST(TremblePath, trembles_at_full_depth_by_no_more_than_its_size_between_8_and_12_hz) {
    const ScriptSettings settings{.tool_radius = 1, .depth = 2, .speed = 20, .tremor = 0.3, .seconds = 6};
    const HandPath path = tremble_path(target, settings, 4);
    const Vector3d deep = target.point + (1 - 2) * target.normal;
    const double in = 4 / 20.0, end = 6 - in;  // 2 mm of clearance and 2 of depth
    EXPECT_LT((path.at(0) - (target.point + 3 * target.normal)).norm(), 1e-12);
    EXPECT_LT((path.at(in) - deep).norm(), 1e-12);
    Vector3d largest = Vector3d::Zero();
    double step = 0;
    for (double t = in; t < end; t += 1e-3) {
        largest = largest.cwiseMax((path.at(t) - deep).cwiseAbs());
        step = std::max(step, (path.at(t + 1e-3) - path.at(t)).norm());
    }
    EXPECT_LE(largest.maxCoeff(), 0.3 + 1e-12);
    EXPECT_GT(largest.minCoeff(), 0.16);
    EXPECT_LT(step, std::sqrt(3) * 0.3 * 2 * std::numbers::pi * 12 * 1e-3 * 1.1);  // no jump
    // The power of each axis, by a Fourier sum over the 4 s of full size in steps of a quarter of a hertz. A
    // window of 4 s spreads a line over half a hertz to either side.
    for (int axis = 0; axis < 3; ++axis) {
        double inside = 0, outside = 0;
        for (double hz = 0.25; hz < 40; hz += 0.25) {
            double c = 0, s = 0;
            for (int i = 0; i < 4000; ++i) {
                const double t = 1 + 1e-3 * i, window = 1 - std::cos(2 * std::numbers::pi * i / 4000);
                const double value = window * (path.at(t) - deep)[axis];
                c += value * std::cos(2 * std::numbers::pi * hz * t);
                s += value * std::sin(2 * std::numbers::pi * hz * t);
            }
            (hz >= 7.5 && hz <= 12.5 ? inside : outside) += c * c + s * s;
        }
        EXPECT_LT(outside, 1e-3 * inside) << "axis " << axis;
    }
    EXPECT_LT((path.at(99) - path.at(0)).norm(), 1e-12);
    EXPECT_NEAR(path.duration(), 6, 2e-3);
}

TEST(TremblePath, the_seed_decides) {
    EXPECT_EQ(tremble_path(target, {}, 1).at(1.7), tremble_path(target, {}, 1).at(1.7));
    EXPECT_NE(tremble_path(target, {}, 1).at(1.7), tremble_path(target, {}, 2).at(1.7));
}

TEST(LetGoPath, lets_go_deep_and_takes_hold_outside) {
    const ScriptSettings settings{.tool_radius = 1, .depth = 3, .speed = 20, .hold_s = 0.5, .seconds = 2};
    const HandPath path = let_go_path(target, settings);
    const double in = 0.25;  // 5 mm at 20 mm/s
    EXPECT_TRUE(path.holds_at(in + 0.499));
    EXPECT_NEAR(path.at(in + 0.499).z(), 1, 1e-12);
    for (double t = in + 0.501; t < in + 0.5 + in + 0.499; t += 0.01) EXPECT_FALSE(path.holds_at(t)) << t;
    const double again = in + 0.5 + in + 0.501;
    EXPECT_TRUE(path.holds_at(again));
    EXPECT_NEAR(path.at(again).z(), 3 + 1 + 2, 1e-12);
    EXPECT_TRUE(path.holds_at(99));
    EXPECT_GE(path.duration(), 2);
}

TEST(RecordedAxisPath, goes_from_clear_of_the_surface_to_full_depth_with_the_recording) {
    const ScriptSettings settings{.tool_radius = 1, .depth = 3};
    const HandPath path = recorded_axis_path(target, settings, std::vector<double>{10, 30, 20, 10});
    EXPECT_NEAR(path.at(0).z(), 3 + 1 + 2, 1e-12);
    EXPECT_NEAR(path.at(0.001).z(), 3 + 1 - 3, 1e-12);
    EXPECT_NEAR(path.at(0.002).z(), 3 + 1 - 0.5, 1e-12);
    EXPECT_LT((path.at(0.0015) - target.point).head<2>().norm(), 1e-12);
    EXPECT_EQ(path.duration(), 0.003);
}

TEST(RecordedAxisPath, refuses_a_recording_that_does_not_move) {
    EXPECT_THROW(recorded_axis_path(target, {}, std::vector<double>{5, 5, 5}), InvalidInput);
    EXPECT_THROW(recorded_axis_path(target, {}, std::vector<double>{}), InvalidInput);
}

TEST(Scripts, refuse_settings_that_make_no_motion) {
    const auto refused = [](const std::function<void(ScriptSettings&)>& spoil) {
        ScriptSettings settings;
        spoil(settings);
        EXPECT_THROW(press_path(target, settings), UsageError);
        EXPECT_THROW(slide_path(target, settings), UsageError);
        EXPECT_THROW(random_path(target, settings, 1), UsageError);
        EXPECT_THROW(tremble_path(target, settings, 1), UsageError);
        EXPECT_THROW(let_go_path(target, settings), UsageError);
        EXPECT_THROW(recorded_axis_path(target, settings, std::vector<double>{1, 2}), UsageError);
    };
    refused([](ScriptSettings& s) { s.speed = 0; });
    refused([](ScriptSettings& s) { s.depth = -1; });
    refused([](ScriptSettings& s) { s.seconds = std::nan(""); });
}

}  // namespace
}  // namespace palpate
