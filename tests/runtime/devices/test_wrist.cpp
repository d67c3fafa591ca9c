// SPDX-License-Identifier: Apache-2.0
// A simulated device with motors in its gimbal: how its tool turns in a hand.
#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <random>
#include <vector>

#include "formats/model/arrays.hpp"
#include "formats/model/errors.hpp"
#include "formats/model/geometry/rotations.hpp"
#include "runtime/devices/dynamics/dynamic_device.hpp"
#include "tests/runtime/allocation_trap.hpp"

namespace palpate {
namespace {

using namespace devices;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double inertia = 0.05;       // N mm s², of gimbal()
constexpr double wrist_error = 1e-10;  // relative, of some thousand steps about one axis
constexpr HandImpedance nothing_holds{
    .stiffness = 0, .damping = 0, .torsional_stiffness = 0, .torsional_damping = 0};

DeviceModel gimbal() {
    return {.name = "plain",
            .mass_kg = 0.05,
            .damping = 5e-4,
            .max_force = 99,
            .inertia_kg_mm2 = 1e3 * inertia,
            .torsional_damping = 0,
            .max_torque = 500};
}

HandPath hand_at(const Quaterniond& orientation = Quaterniond::Identity()) {
    return HandPath({{0, Vector3d::Zero(), true, orientation}});
}

// Since the identity, rad.
Vector3d turn_of(const DynamicDevice& device) {
    return rotation_between(Quaterniond::Identity(), device.wrist()->orientation());
}

void twist(DynamicDevice& device, const Vector3d& torque) {
    device.write({{0, 0, 0}, array_of(torque)});
}

TEST(Wrist, without_hand_and_damping_a_constant_torque_accelerates_uniformly) {
    DynamicDevice device(gimbal(), nothing_holds, hand_at());
    const Vector3d torque(20, -10, 5);  // N mm
    twist(device, torque);
    device.read(0.05);
    const Vector3d acceleration = torque / inertia;  // rad/s²
    EXPECT_LT((device.wrist()->angular_velocity() - 0.05 * acceleration).norm(),
              wrist_error * acceleration.norm());
    EXPECT_LT((turn_of(device) - 0.5 * 0.05 * 0.05 * acceleration).norm(), wrist_error * acceleration.norm());
}

TEST(Wrist, a_constant_torque_settles_where_the_hands_spring_bears_it) {
    const HandImpedance hand{.torsional_stiffness = 250, .torsional_damping = 2};
    const Quaterniond wish(Eigen::AngleAxisd(0.7, Vector3d(1, 2, -2).normalized()));
    DynamicDevice device(gimbal(), hand, hand_at(wish));
    const Vector3d torque(30, 80, -20);
    twist(device, torque);
    const auto state = device.read(2);
    const Vector3d turn = rotation_between(wish, quaternion_of(state.orientation));
    EXPECT_LT((turn - torque / 250).norm(), 1e-9);
    EXPECT_LT((vector_of(state.shaft) - quaternion_of(state.orientation) * Vector3d::UnitZ()).norm(), 1e-12);
}

TEST(Wrist, lags_a_hand_that_turns_uniformly_by_what_its_own_damping_takes) {
    DeviceModel model = gimbal();
    model.torsional_damping = 0.3;
    const HandImpedance hand{.torsional_stiffness = 250, .torsional_damping = 2};
    std::vector<HandPath::Key> keys;
    for (int k = 0; k <= 4; ++k)
        keys.push_back(
            {0.5 * k, Vector3d::Zero(), true, Quaterniond(Eigen::AngleAxisd(0.8 * k, Vector3d::UnitY()))});
    DynamicDevice device(model, hand, HandPath(keys));
    device.read(1.5);
    EXPECT_NEAR(device.wrist()->angular_velocity().y(), 1.6, 1e-7);
    const Quaterniond wish(Eigen::AngleAxisd(2.4, Vector3d::UnitY()));
    EXPECT_NEAR(rotation_between(wish, device.wrist()->orientation()).y(), -0.3 * 1.6 / 250, 1e-9);
}

TEST(Wrist, energy_never_grows_without_torque) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> uniform(0, 1);
    for (int trial = 0; trial < 20; ++trial) {
        DeviceModel model = gimbal();
        model.torsional_damping = 0.02 + uniform(random);
        const HandImpedance hand{.torsional_stiffness = 500 * uniform(random),
                                 .torsional_damping = 3 * uniform(random)};
        DynamicDevice device(model, hand, hand_at());
        twist(device, 400 * Vector3d(uniform(random), uniform(random), uniform(random)));
        device.read(0.03);
        // Turned about one axis and pushed about another.
        twist(device, 400 * Vector3d(-uniform(random), uniform(random), 0));
        device.read(0.04);
        twist(device, Vector3d::Zero());
        const auto energy = [&] {
            return 0.5 * inertia * device.wrist()->angular_velocity().squaredNorm() +
                   0.5 * hand.torsional_stiffness * turn_of(device).squaredNorm();
        };
        double last = energy();
        const double first = last;
        ASSERT_GT(first, 0);
        for (int step = 1; step <= 4000; ++step) {
            device.read(0.04 + step * DynamicDevice::step_s);
            const double now = energy();
            ASSERT_LE(now, last + 1e-12 * first) << "trial " << trial << ", step " << step;
            last = now;
        }
    }
}

TEST(Wrist, the_motors_saturate_and_keep_their_axis_and_their_warmth_is_told) {
    DeviceModel model = gimbal();
    model.max_torque = 50;
    model.max_continuous_torque = 25;
    model.thermal_time_s = 0.2;
    const HandImpedance hand{.torsional_stiffness = 250, .torsional_damping = 2};
    DynamicDevice device(model, hand, hand_at()), at_limit(model, hand, hand_at());
    twist(device, {300, 0, -400});
    twist(at_limit, {30, 0, -40});
    const auto state = device.read(1);
    EXPECT_EQ(state.orientation, at_limit.read(1).orientation);
    EXPECT_EQ(state.faults, motors_warm);
    EXPECT_EQ(device.motor_temperature(), 0) << "those that push do nothing";
    EXPECT_EQ(device.limits().max_torque, 50);
    EXPECT_EQ(device.limits().max_continuous_torque, 25);
}

TEST(Wrist, a_torque_acts_its_delay_later) {
    DeviceModel model = gimbal();
    model.delay_ticks = 3;
    DynamicDevice device(model, nothing_holds, hand_at());
    for (int tick = 0; tick < 6; ++tick) {
        device.read(1e-3 * tick);
        EXPECT_EQ(turn_of(device).norm() > 0, tick > 3) << tick;
        twist(device, {0, 10, 0});
    }
}

TEST(Wrist, a_hand_that_lets_go_leaves_the_tool_turning_and_takes_hold_without_a_jump) {
    DynamicDevice device(gimbal(), {},
                         HandPath({{0, Vector3d::Zero(), true, Quaterniond::Identity()},
                                   {0.1, Vector3d::Zero(), false, Quaterniond::Identity()},
                                   {0.5, Vector3d::Zero(), true, Quaterniond::Identity()}}));
    device.read(0.1);
    twist(device, {0, 0, 10});
    device.read(0.12);
    twist(device, Vector3d::Zero());
    device.read(0.2);
    EXPECT_NEAR(device.wrist()->angular_velocity().z(), 10 * 0.02 / inertia, 1e-6) << "nothing holds it";
    double turned_before = turn_of(device).z();
    for (int tick = 201; tick <= 3000; ++tick) {
        device.read(1e-3 * tick);
        // rad in a ms: the 4 rad/s it had, or what the hand draws it back by.
        EXPECT_LT(std::abs(turn_of(device).z() - turned_before), 5e-3) << tick;
        turned_before = turn_of(device).z();
    }
    EXPECT_LT(turn_of(device).norm(), 1e-6);
}

TEST(Wrist, a_tool_is_held_along_the_shaft_where_the_hand_says_no_more) {
    const Vector3d shaft = Vector3d(1, 1, 0).normalized();
    DynamicDevice device(gimbal(), {}, HandPath({{0, Vector3d::Zero()}}), array_of(shaft));
    EXPECT_LT((vector_of(device.read(0.1).shaft) - shaft).norm(), 1e-12);
    twist(device, {0, 0, 40});
    EXPECT_GT((vector_of(device.read(0.6).shaft) - shaft).norm(), 0.1);
    DynamicDevice unknown(gimbal(), {}, HandPath({{0, Vector3d::Zero()}}));
    twist(unknown, {0, 0, 40});
    EXPECT_EQ(unknown.wrist(), nullptr);
    EXPECT_EQ(unknown.read(0.1).orientation, (std::array<double, 4>{0, 0, 0, 0}));
}

TEST(Wrist, a_device_without_motors_in_its_gimbal_is_not_turned) {
    DynamicDevice device(find_device_model("premium"), {}, hand_at());
    twist(device, {0, 0, 400});
    EXPECT_EQ(device.read(0.5).orientation, array_of(Quaterniond::Identity()));
    EXPECT_EQ(device.limits().max_torque, 0);
}

TEST(Wrist, figures_that_no_gimbal_has_are_refused) {
    const auto refused = [](const std::function<void(DeviceModel&, HandImpedance&)>& spoil) {
        DeviceModel model = gimbal();
        HandImpedance hand;
        spoil(model, hand);
        EXPECT_THROW(DynamicDevice(model, hand, hand_at()), InvalidInput);
    };
    refused([](DeviceModel& model, HandImpedance&) { model.inertia_kg_mm2 = 0; });
    refused([](DeviceModel& model, HandImpedance&) { model.max_torque = -1; });
    refused([](DeviceModel& model, HandImpedance&) { model.torsional_damping = std::nan(""); });
    refused([](DeviceModel&, HandImpedance& hand) { hand.torsional_stiffness = -1; });
    refused([](DeviceModel&, HandImpedance& hand) { hand.torsional_damping = -1; });
}

TEST(Wrist, turns_without_allocation) {
    DynamicDevice device(find_device_model("premium-6dof"), {}, hand_at());
    const AllocationTrap trap;
    for (int tick = 0; tick < 100; ++tick) {
        device.read(1e-3 * tick);
        twist(device, {10, 20, 30});
    }
    EXPECT_EQ(trap.count(), 0U);
}

}  // namespace
}  // namespace palpate
