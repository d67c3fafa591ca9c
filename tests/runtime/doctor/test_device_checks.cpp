// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "runtime/doctor/checks/device_checks.hpp"
#include "tests/runtime/doctor/made_up_machine.hpp"

namespace palpate {
namespace {

using namespace doctor;
using namespace realtime;
using sample::find;
using ::testing::HasSubstr;

struct DeviceChecks : testing::Test {
    std::vector<DeviceState> states = std::vector<DeviceState>(10, DeviceState{.position = {3, -40, 12}});
    OpenedDevice device{.name = "Default Device",
                        .limits = {.max_force = 3.3,
                                   .max_stiffness = 0.5,
                                   .max_continuous_force = 0.88,
                                   .rate_hz = 1000,
                                   .workspace_low = {-80, -60, -35},
                                   .workspace_high = {80, 60, 35}}};

    Findings check() {
        device.first_states = states;
        return device_findings(device);
    }
};

TEST_F(DeviceChecks, a_device_in_order_has_nothing_but_ok) {
    const Findings findings = check();
    EXPECT_EQ(count(findings, Level::ok), findings.size());
    EXPECT_EQ(find(findings, "workspace").found, "160 x 120 x 70 mm");
}

TEST_F(DeviceChecks, a_device_that_rests_elsewhere_is_not_frozen) {
    for (DeviceState& state : states) state.position = {0, -65.51, -88.11};  // a Touch in its inkwell
    EXPECT_EQ(find(check(), "pose").level, Level::ok);
}

TEST_F(DeviceChecks, the_pose_of_all_joint_angles_zero_is_a_driver_without_encoder_data) {
    for (DeviceState& state : states) state.position = {0, -110, -35};
    EXPECT_EQ(find(check(), "pose").level, Level::problem);
    states.back().position = {0, -109.8, -35};
    EXPECT_EQ(find(check(), "pose").level, Level::ok);
}

TEST_F(DeviceChecks, no_position_at_all_is_a_problem) {
    states.clear();
    EXPECT_EQ(find(check(), "pose").level, Level::problem);
}

TEST_F(DeviceChecks, calibration_that_needs_a_hand_is_a_problem) {
    device.calibration = Calibration::needs_update;
    EXPECT_EQ(find(check(), "calibration").level, Level::warning);
    device.calibration = Calibration::needs_manual_input;
    EXPECT_EQ(find(check(), "calibration").level, Level::problem);
    EXPECT_THAT(find(check(), "calibration").fix, HasSubstr("inkwell"));
}

TEST_F(DeviceChecks, each_fault_is_named_with_its_remedy) {
    states[3].faults = motors_warm;
    states[4].faults = device_lost;
    const Finding finding = find(check(), "faults");
    EXPECT_EQ(finding.level, Level::problem);
    EXPECT_EQ(finding.found, fault_names(motors_warm | device_lost));
    EXPECT_EQ(std::ranges::count(finding.fix, '\n'), 1);
}

TEST_F(DeviceChecks, unknown_limits_and_workspace_are_warnings) {
    device.limits = {};
    EXPECT_EQ(find(check(), "limits").level, Level::warning);
    EXPECT_EQ(find(check(), "workspace").level, Level::warning);
}

}  // namespace
}  // namespace palpate
