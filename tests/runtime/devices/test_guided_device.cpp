// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <gtest/gtest.h>

#include "formats/model/arrays.hpp"
#include "runtime/devices/guided_device.hpp"

namespace palpate {
namespace {

using namespace devices;
using Eigen::AngleAxisd;
using Eigen::Quaterniond;
using Eigen::Vector3d;

TEST(GuidedDevice, follows_its_target_no_faster_than_allowed) {
    GuidedDevice device({{0, 0, 0}}, {.max_force = 3, .max_stiffness = 0.5}, 200);
    device.set_target({{1, 0, 0}});
    double last = 0;
    for (int tick = 1; tick <= 10; ++tick) {
        const double x = device.read(1e-3 * tick).position[0];
        EXPECT_LE(x - last, 0.2 + 1e-12);
        last = x;
    }
    EXPECT_DOUBLE_EQ(last, 1);
    device.set_target({{1, 0.1, 0}});
    EXPECT_DOUBLE_EQ(device.read(0.011).position[1], 0.1);
}

TEST(GuidedDevice, stays_when_time_does_not_pass) {
    GuidedDevice device({{0, 0, 0}}, {}, 200);
    device.read(1);
    device.set_target({{5, 0, 0}});
    EXPECT_EQ(device.read(1).position[0], 0);
}

TEST(GuidedDevice, turns_to_its_target_no_faster_than_a_hand_and_stays_where_nobody_says) {
    const Quaterniond start(AngleAxisd(0.3, Vector3d::UnitX())),
        target(AngleAxisd(0.4, Vector3d::UnitY()) * start);
    GuidedDevice device({{0, 0, 0}, array_of(start)}, {}, 200);
    const auto orientation_at = [&](double time) { return quaternion_of(device.read(time).orientation); };
    device.set_target({{0, 0, 0}, array_of(target)});
    Quaterniond last = start;
    for (int tick = 1; tick <= 300; ++tick) {
        const Quaterniond now = orientation_at(1e-3 * tick);
        EXPECT_LE(now.angularDistance(last), 1e-3 * GuidedHand::turning_speed + 1e-9);
        last = now;
    }
    EXPECT_LT(last.angularDistance(target), 1e-9);
    device.set_target({{0, 0, 0}});
    EXPECT_LT(orientation_at(1).angularDistance(target), 1e-9);
    EXPECT_LT((vector_of(device.read(1).shaft) - target * Vector3d::UnitZ()).norm(), 1e-9);
}

TEST(GuidedDevice, says_nothing_of_how_a_tool_is_turned_that_does_not_turn) {
    GuidedDevice device({{0, 0, 0}}, {}, 200, {0, 0, 1});
    device.set_target({{0, 0, 0}, {0, 0, 0, 1}});
    const realtime::DeviceState state = device.read(1);
    EXPECT_EQ(state.orientation, (std::array<double, 4>{0, 0, 0, 0}));
    EXPECT_EQ(state.shaft, (std::array<double, 3>{0, 0, 1}));
}

}  // namespace
}  // namespace palpate
