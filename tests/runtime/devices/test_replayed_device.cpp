// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "formats/model/errors.hpp"
#include "runtime/devices/replayed_device.hpp"

namespace palpate {
namespace {

using namespace devices;
using namespace realtime;

std::vector<DeviceState> three_states() {
    std::vector<DeviceState> states(3);
    for (std::size_t i = 0; i < 3; ++i) {
        states[i].position = {static_cast<double>(i), 0.5, -1};
        states[i].shaft = {0, 0, 1};
        states[i].buttons = 1U << i;
    }
    states[1].faults = motors_warm;
    return states;
}

TEST(ReplayedDevice, is_where_the_nearest_tick_was) {
    ReplayedDevice device(three_states(), {.max_force = 3});
    EXPECT_EQ(device.limits().max_force, 3);
    EXPECT_EQ(device.read(0).position[0], 0);
    EXPECT_EQ(device.read(0.00049).position[0], 0);
    const DeviceState second = device.read(0.001);
    EXPECT_EQ(second.position, (std::array<double, 3>{1, 0.5, -1}));
    EXPECT_EQ(second.shaft[2], 1);
    EXPECT_EQ(second.buttons, 2U);
    EXPECT_EQ(second.faults, motors_warm);
    EXPECT_EQ(second.time, 0.001);
}

TEST(ReplayedDevice, stays_at_its_first_and_last_state_outside_of_them) {
    ReplayedDevice device(three_states(), {});
    EXPECT_EQ(device.read(-1).position[0], 0);
    EXPECT_EQ(device.read(7).position[0], 2);
}

TEST(ReplayedDevice, of_nothing_is_refused) {
    EXPECT_THROW(ReplayedDevice({}, {}), InvalidInput);
}

}  // namespace
}  // namespace palpate
