// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <gtest/gtest.h>

#include "runtime/devices/guided_device.hpp"

namespace palpate {
namespace {

using namespace devices;

TEST(GuidedDevice, follows_its_target_no_faster_than_allowed) {
    GuidedDevice device({0, 0, 0}, {.max_force = 3, .max_stiffness = 0.5}, 200);
    device.set_target({1, 0, 0});
    double last = 0;
    for (int tick = 1; tick <= 10; ++tick) {
        const double x = device.read(1e-3 * tick).position[0];
        EXPECT_LE(x - last, 0.2 + 1e-12);
        last = x;
    }
    EXPECT_DOUBLE_EQ(last, 1);
    device.set_target({1, 0.1, 0});
    EXPECT_DOUBLE_EQ(device.read(0.011).position[1], 0.1);
}

TEST(GuidedDevice, stays_when_time_does_not_pass) {
    GuidedDevice device({0, 0, 0}, {}, 200);
    device.read(1);
    device.set_target({5, 0, 0});
    EXPECT_EQ(device.read(1).position[0], 0);
}

}  // namespace
}  // namespace palpate
