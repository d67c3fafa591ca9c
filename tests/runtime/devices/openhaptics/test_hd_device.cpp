// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>
#include <memory>
#include <numbers>

#include "formats/model/arrays.hpp"
#include "formats/model/errors.hpp"
#include "runtime/devices/openhaptics/hd_device.hpp"
#include "tests/runtime/allocation_trap.hpp"
#include "tests/runtime/devices/openhaptics/fake_hd_driver.hpp"

namespace palpate {
namespace {

using namespace devices;
using namespace realtime;
using namespace hdapi;
using Eigen::Vector3d;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr double axes_error = 1e-12;  // of a rotation made of a matrix and back

class HdDeviceTest : public testing::Test {
  protected:
    explicit HdDeviceTest(std::vector<const char*> names = {nullptr}) {
        reset_fake_hd_driver(std::move(names));
    }

    HdDevice& open(const std::string& name = "", bool or_default = true) {
        devices_.push_back(std::make_unique<HdDevice>(fake_hd_api(), errors_, name, or_default));
        return *devices_.back();
    }
    static FakeHdDevice& behind(std::size_t handle = 0) { return fake_hd_driver().devices[handle]; }
    static std::uint32_t tick(HdDevice& device, int times = 1) {
        std::uint32_t faults = no_fault;
        for (int i = 0; i < times; ++i) {
            faults = device.read(0).faults;
            device.write({});
        }
        return faults;
    }
    // Turns the stylus by R, its axes' lengths as given.
    static void turn(const Eigen::Matrix3d& R, const Vector3d& lengths = Vector3d::Ones()) {
        behind().stylus_x = array_of(Vector3d(lengths.x() * R.col(0)));
        behind().stylus_y = array_of(Vector3d(lengths.y() * R.col(1)));
        behind().stylus = array_of(Vector3d(lengths.z() * R.col(2)));
    }
    void close_all() { devices_.clear(); }

    HdErrorSorter errors_{fake_hd_api()};
    std::vector<std::unique_ptr<HdDevice>> devices_;
};

TEST_F(HdDeviceTest, the_default_device_is_asked_for_by_the_null_pointer_first) {
    open();
    EXPECT_THAT(fake_hd_driver().asked, ElementsAre("NULL"));
    EXPECT_TRUE(behind().open);
    EXPECT_TRUE(behind().force_output);
}

TEST_F(HdDeviceTest, a_default_device_that_has_a_name_only_is_found) {
    reset_fake_hd_driver({"Default PHANToM"});
    EXPECT_FALSE(open().opened_instead());
    EXPECT_THAT(fake_hd_driver().asked, ElementsAre("NULL", "Default Device", "Default PHANToM"));
}

TEST_F(HdDeviceTest, a_name_that_the_driver_does_not_open_falls_back_to_the_default_and_says_so) {
    const HdDevice& device = open("Left");
    EXPECT_TRUE(device.opened_instead());
    EXPECT_THAT(device.name(), HasSubstr("default device for 'Left'"));
}

TEST_F(HdDeviceTest, one_of_several_names_is_never_opened_by_another) {
    try {
        open("Left", false);
        FAIL() << "nothing was thrown";
    } catch (const SystemFailure& error) {
        EXPECT_EQ(error.detail().culprit, "device 'Left'");
        EXPECT_THAT(error.detail().found, HasSubstr("0x303"));
    }
    EXPECT_THAT(fake_hd_driver().asked, ElementsAre("Left"));
}

TEST_F(HdDeviceTest, a_missing_licence_is_no_reason_to_try_other_names) {
    fake_hd_driver().unknown_name = invalid_licence;
    EXPECT_THROW(open("Left"), SystemFailure);
    EXPECT_THAT(fake_hd_driver().asked, ElementsAre("Left"));
}

TEST_F(HdDeviceTest, a_device_without_force_output_is_closed_and_refused) {
    fake_hd_driver().enable_error = device_fault;
    EXPECT_THROW(open(), SystemFailure);
    EXPECT_FALSE(behind().open);
}

TEST_F(HdDeviceTest, closing_switches_the_force_output_off) {
    open();
    close_all();
    EXPECT_FALSE(behind().force_output);
    EXPECT_FALSE(behind().open);
}

TEST_F(HdDeviceTest, a_limit_that_the_driver_does_not_know_is_zero) {
    const DeviceLimits limits = open().limits();
    EXPECT_EQ(limits.max_force, 3.3);
    EXPECT_EQ(limits.max_stiffness, 0);
    EXPECT_EQ(limits.rate_hz, 1000);
    EXPECT_EQ(limits.workspace_high[0], 0);
}

TEST_F(HdDeviceTest, a_gimbal_with_motors_gets_its_torque_and_another_none) {
    behind().output_dof = 6;
    HdDevice& device = open();
    EXPECT_EQ(device.limits().max_torque, 170);
    device.read(0);
    device.write({{1, 2, 3}, {40, -50, 60}});
    EXPECT_THAT(behind().force, ElementsAre(1, 2, 3));
    EXPECT_THAT(behind().torque, ElementsAre(40, -50, 60));
    close_all();

    reset_fake_hd_driver();
    HdDevice& without = open();
    EXPECT_EQ(without.limits().max_torque, 0);
    without.read(0);
    without.write({{1, 2, 3}, {40, -50, 60}});
    EXPECT_THAT(behind().torque, ElementsAre(0, 0, 0));
    EXPECT_EQ(without.read(1e-3).faults, no_fault);
}

TEST_F(HdDeviceTest, a_driver_that_refuses_torque_is_not_asked_again) {
    behind().output_dof = 6;
    behind().takes_torque = false;
    HdDevice& device = open();
    EXPECT_EQ(device.limits().max_torque, 0);
    EXPECT_FALSE(behind().in_frame);
    device.read(0);
    device.write({{1, 2, 3}, {40, -50, 60}});
    EXPECT_THAT(behind().force, ElementsAre(1, 2, 3));
    EXPECT_EQ(device.read(1e-3).faults, no_fault);
    EXPECT_TRUE(fake_hd_driver().errors.empty());
}

TEST_F(HdDeviceTest, a_glitch_of_the_encoders_is_a_fault_and_a_fast_hand_is_none) {
    HdDevice& device = open();
    double time = 0;
    const auto read_at = [&](double x) {
        behind().position = {x, 0, 0};
        const DeviceState state = device.read(time += 1e-3);
        device.write({});
        return state;
    };
    for (int k = 0; k < 20; ++k) EXPECT_EQ(read_at(2.0 * k).faults, no_fault) << "2 m/s";
    const DeviceState glitch = read_at(38 + 6);
    EXPECT_EQ(glitch.faults, implausible_speed);
    EXPECT_THAT(glitch.position, ElementsAre(38, 0, 0));
    EXPECT_EQ(read_at(38).faults, no_fault);
    // What stays 12 mm off is where the stylus is, 3 ms later: 4 m/s.
    EXPECT_EQ(read_at(50).faults, implausible_speed);
    EXPECT_EQ(read_at(50).faults, implausible_speed);
    EXPECT_EQ(read_at(50).faults, no_fault);
}

TEST_F(HdDeviceTest, the_state_is_the_drivers_and_the_shaft_the_stylus_own_z_axis) {
    HdDevice& device = open();
    behind().position = {1, -2, 3};
    behind().stylus = {0, 0, 2};  // unit in HDAPI; a length that is not must not reach the tool
    behind().buttons = 2;
    const DeviceState state = device.read(0.25);
    EXPECT_THAT(state.position, ElementsAre(1, -2, 3));
    EXPECT_THAT(state.shaft, ElementsAre(0, 0, 1));
    EXPECT_EQ(state.buttons, 2u);
    EXPECT_EQ(state.time, 0.25);
    EXPECT_EQ(state.faults, no_fault);
}

TEST_F(HdDeviceTest, the_orientation_is_the_rotation_of_the_drivers_transform) {
    HdDevice& device = open();
    const Vector3d axis = Vector3d(1, 2, -2).normalized();
    for (const double angle : {0.0, 0.4, 1.9, std::numbers::pi, 4.5}) {
        const Eigen::Matrix3d R = Eigen::AngleAxisd(angle, axis).toRotationMatrix();
        for (const Vector3d& lengths : {Vector3d(1, 1, 1), Vector3d(2, 0.5, 3)}) {
            turn(R, lengths);
            const DeviceState state = device.read(0);
            const Eigen::Quaterniond orientation = quaternion_of(state.orientation);
            EXPECT_NEAR(orientation.norm(), 1, axes_error);
            EXPECT_LT((orientation.toRotationMatrix() - R).norm(), axes_error) << angle;
            EXPECT_LT((orientation * Vector3d::UnitZ() - vector_of(state.shaft)).norm(), axes_error);
        }
    }
}

TEST_F(HdDeviceTest, a_transform_whose_x_axis_says_nothing_gives_the_shaft_alone) {
    HdDevice& device = open();
    turn(Eigen::AngleAxisd(0.7, Vector3d::UnitX()).toRotationMatrix());
    const std::array<double, 3> shaft = behind().stylus;
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const std::array<double, 3>& x : {std::array{0.0, 0.0, 0.0}, {nan, 0.0, 0.0}}) {
        behind().stylus_x = x;
        const DeviceState state = device.read(0);
        EXPECT_LT((vector_of(state.shaft) - vector_of(shaft)).norm(), axes_error);
        EXPECT_THAT(state.orientation, ElementsAre(0, 0, 0, 0));
    }
}

TEST_F(HdDeviceTest, frames_of_two_devices_overlap_and_each_gets_its_own_force) {
    reset_fake_hd_driver({"Left", "Right"});
    HdDevice &left = open("Left", false), &right = open("Right", false);
    left.read(0);
    right.read(0);
    EXPECT_TRUE(behind(0).in_frame && behind(1).in_frame);
    left.write({{1, 0, 0}});
    right.write({{0, 2, 0}});
    EXPECT_THAT(behind(0).force, ElementsAre(1, 0, 0));
    EXPECT_THAT(behind(1).force, ElementsAre(0, 2, 0));
    EXPECT_FALSE(behind(0).in_frame || behind(1).in_frame);
    EXPECT_TRUE(fake_hd_driver().errors.empty());
}

TEST_F(HdDeviceTest, a_write_without_a_read_and_a_second_read_break_no_frame) {
    HdDevice& device = open();
    device.write({{1, 0, 0}});
    EXPECT_EQ(behind().frames, 0);
    device.read(0);
    device.read(0);
    device.write({{1, 0, 0}});
    EXPECT_EQ(behind().frames, 1);
    EXPECT_EQ(device.read(0).faults, no_fault);
}

TEST_F(HdDeviceTest, is_lost_while_errors_come_and_no_longer) {
    HdDevice& device = open();
    tick(device);
    fake_hd_driver().errors.push_back({comm_error, 0, 0});
    EXPECT_EQ(tick(device), device_lost);
    EXPECT_EQ(tick(device), no_fault);
}

TEST_F(HdDeviceTest, motors_are_warm_from_their_limit_until_they_have_cooled_down) {
    HdDevice& device = open();
    behind().temperature = 0.99;
    EXPECT_EQ(tick(device, HdDevice::look_ticks), no_fault);
    behind().temperature = 1;
    EXPECT_EQ(tick(device, HdDevice::look_ticks), motors_warm);
    behind().temperature = 0.95;
    EXPECT_EQ(tick(device, HdDevice::look_ticks), motors_warm);
    behind().temperature = 0.89;
    EXPECT_EQ(tick(device, HdDevice::look_ticks), no_fault);
}

TEST_F(HdDeviceTest, a_pose_without_encoder_data_is_a_fault_when_it_lasts) {
    HdDevice& device = open();
    behind().position = {0, -110, -35};
    EXPECT_EQ(tick(device, 2 * HdDevice::frozen_ticks), no_fault);  // a hand may hold it there
    behind().joint_angles = {0, 0, 0};
    EXPECT_EQ(tick(device, HdDevice::frozen_ticks), no_fault);
    EXPECT_EQ(tick(device), pose_frozen);
    behind().position[0] = 2e-6;
    EXPECT_EQ(tick(device), no_fault);
}

TEST_F(HdDeviceTest, a_calibration_is_a_fault_until_it_is_up_to_date) {
    HdDevice& device = open();
    tick(device);
    behind().calibration = calibration_needs_update;
    EXPECT_EQ(tick(device, HdDevice::look_ticks), not_calibrated);
    EXPECT_EQ(device.calibration(), Calibration::needs_update);
    EXPECT_EQ(behind().updates, 0);  // never in the servo
    device.calibrate();
    EXPECT_EQ(behind().updates, 1);
    EXPECT_EQ(tick(device), no_fault);
    EXPECT_EQ(device.calibration(), Calibration::ok);
    behind().calibration = calibration_needs_manual_input;
    EXPECT_EQ(tick(device, HdDevice::look_ticks), not_calibrated);
}

TEST_F(HdDeviceTest, a_calibration_that_its_update_does_not_help_is_a_fault) {
    HdDevice& device = open();
    behind().calibration = calibration_needs_update;
    tick(device);
    device.calibrate();
    behind().calibration = calibration_needs_update;
    EXPECT_EQ(tick(device), not_calibrated);
    behind().calibration = calibration_ok;
    EXPECT_EQ(tick(device, HdDevice::look_ticks), no_fault);
}

TEST_F(HdDeviceTest, a_pose_that_may_be_of_no_encoders_does_not_drag_the_tool) {
    HdDevice& device = open();
    behind().position = {1, 2, 3};
    tick(device);
    behind().position = {0, -110, -35};
    behind().joint_angles = {0, 0, 0};
    for (int i = 0; i <= HdDevice::frozen_ticks + 5; ++i) {
        const DeviceState state = device.read(0);
        device.write({});
        EXPECT_THAT(state.position, ElementsAre(1, 2, 3));
        EXPECT_EQ(state.faults, i < HdDevice::frozen_ticks ? no_fault : pose_frozen) << i;
    }
    behind().position = {1, 2, 4};
    EXPECT_THAT(device.read(0).position, ElementsAre(1, 2, 4));
}

// Beside the position, the pose has a transform, which a tool that turns would follow as readily.
TEST_F(HdDeviceTest, a_pose_that_may_be_of_no_encoders_does_not_turn_the_tool) {
    HdDevice& device = open();
    behind().position = {1, 2, 3};
    turn(Eigen::AngleAxisd(0.9, Vector3d(1, 1, 0).normalized()).toRotationMatrix());
    const DeviceState good = device.read(0);
    device.write({});
    behind().position = {0, -110, -35};
    behind().joint_angles = {0, 0, 0};
    turn(Eigen::Matrix3d::Identity());
    for (int i = 0; i <= HdDevice::frozen_ticks + 5; ++i) {
        const DeviceState state = device.read(0);
        device.write({});
        EXPECT_EQ(state.orientation, good.orientation) << i;
        EXPECT_EQ(state.shaft, good.shaft) << i;
    }
    behind().position = {1, 2, 4};
    EXPECT_THAT(device.read(0).shaft, ElementsAre(0, 0, 1));
}

TEST_F(HdDeviceTest, a_driver_that_gives_no_position_and_says_nothing_is_noticed) {
    HdDevice& device = open();
    tick(device);
    behind().silent = true;
    EXPECT_TRUE(std::isnan(device.read(0).position[0]));
}

TEST_F(HdDeviceTest, a_transform_that_is_no_number_gives_no_shaft) {
    HdDevice& device = open();
    behind().stylus[1] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THAT(device.read(0).shaft, ElementsAre(0, 0, 0));
    EXPECT_THAT(device.read(0).orientation, ElementsAre(0, 0, 0, 0));
}

TEST_F(HdDeviceTest, an_encoder_reset_is_never_done_unasked) {
    behind().styles = encoder_reset;
    behind().calibration = calibration_needs_update;
    HdDevice& device = open();
    EXPECT_EQ(tick(device), not_calibrated);
    device.calibrate();
    EXPECT_EQ(behind().updates, 0);
    EXPECT_THAT(device.how_to_calibrate(), HasSubstr("reset position"));
}

TEST_F(HdDeviceTest, a_tick_allocates_nothing) {
    HdDevice& device = open();
    fake_hd_driver().errors.reserve(8);
    const AllocationTrap trap;
    tick(device, 3 * HdDevice::look_ticks);
    EXPECT_EQ(trap.count(), 0u);
}

}  // namespace
}  // namespace palpate
