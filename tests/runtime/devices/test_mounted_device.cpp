// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "formats/model/arrays.hpp"
#include "runtime/devices/mounted_device.hpp"
#include "tests/runtime/devices/probe_device.hpp"

namespace palpate {
namespace {

using namespace devices;
using namespace realtime;
using Eigen::Vector3d;

constexpr double mounting_error = 1e-12;  // of a few products of numbers around 100

Eigen::Isometry3d some_mount() {
    return mount_upright({1, 2, 3}, {40, -100, 250}, Vector3d(0.3, -0.9, 0.2).normalized());
}

TEST(MountUpright, is_a_rotation_that_puts_the_point_in_place_and_y_up) {
    std::mt19937 random(11);
    std::normal_distribution<double> normal;
    for (int trial = 0; trial < 200; ++trial) {
        const Vector3d p_D(normal(random), normal(random), normal(random));
        const Vector3d p_P(normal(random), normal(random), normal(random));
        const Vector3d up = Vector3d(normal(random), normal(random), normal(random)).normalized();
        const Eigen::Isometry3d X_PD = mount_upright(p_D, p_P, up);
        const Eigen::Matrix3d R = X_PD.linear();
        EXPECT_LT((R.transpose() * R - Eigen::Matrix3d::Identity()).norm(), mounting_error);
        EXPECT_NEAR(R.determinant(), 1, mounting_error);
        EXPECT_LT((X_PD * p_D - p_P).norm(), mounting_error);
        EXPECT_LT((R * Vector3d::UnitY() - up).norm(), mounting_error);
        EXPECT_GE(R(0, 0), -mounting_error);  // the device's x goes with the patient's
    }
}

TEST(MountUpright, holds_where_up_is_along_the_patients_x) {
    for (const double sign : {-1.0, 1.0}) {
        const Eigen::Matrix3d R = mount_upright({0, 0, 0}, {0, 0, 0}, {sign, 0, 0}).linear();
        EXPECT_LT((R.transpose() * R - Eigen::Matrix3d::Identity()).norm(), mounting_error);
        EXPECT_NEAR(R.determinant(), 1, mounting_error);
    }
}

TEST(MountedDevice, positions_and_shaft_come_from_d_to_p_and_everything_else_stays) {
    ProbeDevice probe;
    probe.state.position = {10, -20, 30};
    probe.state.shaft = {0, 0.6, 0.8};
    probe.state.buttons = 2;
    probe.state.faults = motors_warm;
    const Eigen::Isometry3d X_PD = some_mount();
    MountedDevice mounted(probe, X_PD);
    const DeviceState seen = mounted.read(0.25);
    EXPECT_LT((X_PD.inverse() * vector_of(seen.position) - Vector3d(10, -20, 30)).norm(), 1e-10);
    EXPECT_LT((X_PD.linear().transpose() * vector_of(seen.shaft) - Vector3d(0, 0.6, 0.8)).norm(),
              mounting_error);
    EXPECT_EQ(seen.buttons, 2U);
    EXPECT_EQ(seen.faults, motors_warm);
    EXPECT_EQ(seen.time, 0.25);
}

TEST(MountedDevice, an_orientation_is_turned_with_the_device_and_its_z_stays_the_shaft) {
    ProbeDevice probe;
    const Eigen::Quaterniond R_DT(Eigen::AngleAxisd(2, Vector3d(1, -3, 2).normalized()));
    probe.state.orientation = array_of(R_DT);
    probe.state.shaft = array_of(Vector3d(R_DT * Vector3d::UnitZ()));
    const Eigen::Isometry3d X_PD = some_mount();
    MountedDevice mounted(probe, X_PD);
    const DeviceState seen = mounted.read(0);
    const Eigen::Quaterniond R_PT = quaternion_of(seen.orientation);
    EXPECT_NEAR(R_PT.norm(), 1, mounting_error);
    EXPECT_LT((R_PT.toRotationMatrix() - X_PD.linear() * R_DT.toRotationMatrix()).norm(), mounting_error);
    EXPECT_LT((R_PT * Vector3d::UnitZ() - vector_of(seen.shaft)).norm(), mounting_error);
}

TEST(MountedDevice, an_orientation_that_is_not_known_stays_unknown) {
    ProbeDevice probe;
    probe.state.shaft = {0, 0.6, 0.8};
    MountedDevice mounted(probe, some_mount());
    // Zero is compared, not bits: -0 is as unknown as 0.
    EXPECT_EQ(mounted.read(0).orientation, (std::array<double, 4>{0, 0, 0, 0}));
}

TEST(MountedDevice, a_force_goes_back_from_p_to_d_and_its_power_is_the_same_in_both) {
    ProbeDevice probe;
    MountedDevice mounted(probe, some_mount());
    const Vector3d velocity_D(30, -7, 12), force_P(0.5, 1.5, -2);  // mm/s, N
    const Vector3d rate_D(0.3, 2, -1), torque_P(40, -25, 90);      // rad/s, N mm
    probe.state.position = {1, 2, 3};
    const Vector3d before = vector_of(mounted.read(0).position);
    probe.state.position = array_of(Vector3d(1, 2, 3) + velocity_D);
    const Vector3d velocity_P = vector_of(mounted.read(1).position) - before;
    mounted.write({array_of(force_P), array_of(torque_P)});
    EXPECT_NEAR(vector_of(probe.wrench.force).dot(velocity_D), force_P.dot(velocity_P), 1e-10);
    EXPECT_NEAR(vector_of(probe.wrench.force).norm(), force_P.norm(), mounting_error);
    EXPECT_NEAR(vector_of(probe.wrench.torque).dot(rate_D), torque_P.dot(some_mount().linear() * rate_D),
                1e-10);
    EXPECT_NEAR(vector_of(probe.wrench.torque).norm(), torque_P.norm(), 10 * mounting_error);
}

TEST(MountedDevice, states_the_devices_limits_with_a_workspace_that_holds_all_its_corners) {
    ProbeDevice probe;
    const Eigen::Isometry3d X_PD = some_mount();
    const DeviceLimits own = probe.limits(), limits = MountedDevice(probe, X_PD).limits();
    EXPECT_EQ(limits.max_force, own.max_force);
    EXPECT_EQ(limits.max_stiffness, own.max_stiffness);
    EXPECT_EQ(limits.damping, own.damping);
    EXPECT_EQ(limits.max_continuous_force, own.max_continuous_force);
    EXPECT_EQ(limits.rate_hz, own.rate_hz);
    Vector3d low = Vector3d::Constant(1e9), high = -low;
    for (int corner = 0; corner < 8; ++corner) {
        Vector3d p;
        for (std::size_t axis = 0; axis < 3; ++axis)
            p[static_cast<Eigen::Index>(axis)] =
                (corner >> axis & 1) != 0 ? own.workspace_high[axis] : own.workspace_low[axis];
        low = low.cwiseMin(X_PD * p);
        high = high.cwiseMax(X_PD * p);
    }
    EXPECT_LT((vector_of(limits.workspace_low) - low).norm(), 1e-10);
    EXPECT_LT((vector_of(limits.workspace_high) - high).norm(), 1e-10);
    EXPECT_EQ(workspace_middle(own), Vector3d(0, 0, 5));
}

TEST(MountedDevice, may_own_the_device) {
    MountedDevice mounted(std::make_unique<ProbeDevice>(), Eigen::Isometry3d::Identity());
    EXPECT_EQ(mounted.name(), "probe");
}

}  // namespace
}  // namespace palpate
