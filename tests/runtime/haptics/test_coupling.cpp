// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>

#include "formats/model/errors.hpp"
#include "runtime/haptics/servo_loop.hpp"
#include "tests/runtime/haptics/held_tool.hpp"

namespace palpate {
namespace {

using namespace haptics;
using namespace realtime;
using Eigen::Vector3d;

constexpr double clearance = 2e-4;  // mm: the god-object's clearance, and as much again for float32 records

HapticSettings coupled_by(double stiffness) {
    HapticSettings settings;
    settings.coupling_stiffness = stiffness;
    return settings;
}

TEST(CouplingStiffness, is_the_least_of_the_case_the_device_and_twice_its_damping_per_period) {
    // 2 b / T with T = 1 ms: b = 0.2e-3 N s/mm makes 0.4 N/mm.
    EXPECT_DOUBLE_EQ(coupling_stiffness(coupled_by(0.3), {.max_stiffness = 0.5, .damping = 0.2e-3}), 0.3);
    EXPECT_DOUBLE_EQ(coupling_stiffness(coupled_by(0.9), {.max_stiffness = 0.35, .damping = 0.2e-3}), 0.35);
    EXPECT_DOUBLE_EQ(coupling_stiffness(coupled_by(0.9), {.max_stiffness = 0.5, .damping = 0.2e-3}), 0.4);
}

TEST(CouplingStiffness, is_not_limited_by_what_a_device_does_not_state) {
    EXPECT_EQ(coupling_stiffness(coupled_by(7), {}), 7);
    EXPECT_EQ(coupling_stiffness(coupled_by(7), {.max_stiffness = 5}), 5);
    EXPECT_DOUBLE_EQ(coupling_stiffness(coupled_by(7), {.damping = 3e-3}), 6);
    EXPECT_EQ(coupling_stiffness(coupled_by(7), {.max_force = 1e-3}), 7);
}

TEST(CouplingStiffness, refuses_limits_that_are_negative_or_not_finite) {
    const HapticSettings settings;
    for (const double wrong : {-1e-9, -0.5, std::nan(""), std::numeric_limits<double>::infinity()}) {
        EXPECT_THROW(coupling_stiffness(settings, {.max_stiffness = wrong}), InvalidInput) << wrong;
        EXPECT_THROW(coupling_stiffness(settings, {.damping = wrong}), InvalidInput) << wrong;
    }
}

TEST(HapticModel, couples_all_tools_as_the_weakest_device_bears) {
    Case c = plate();
    HapticModel model(c, "continuous", 3);
    const std::array<DeviceLimits, 3> devices{{{.max_stiffness = 0.4}, {.damping = 0.15e-3}, {}}};
    model.couple_to(devices);
    EXPECT_DOUBLE_EQ(model.coupling(), 0.3);
    const std::array<DeviceState, 3> states{held_at({-10, 0, 5}), held_at({0, 0, 5}), held_at({10, 0, 5})};
    const std::array<DeviceState, 3> pressed{held_at({-10, 0, 0}), held_at({0, 0, 0}), held_at({10, 0, 0})};
    std::array<TickResult, 3> results{};
    model.tick(states, results);
    model.tick(pressed, results);
    for (const TickResult& result : results) EXPECT_NEAR(force_of(result).z(), 0.3, 0.3 * clearance);
    model.couple_to({});
    EXPECT_EQ(model.coupling(), c.haptics.coupling_stiffness);
    const std::array<DeviceLimits, 2> wrong{{{}, {.damping = -1}}};
    EXPECT_THROW(model.couple_to(wrong), InvalidInput);
    const std::array<DeviceLimits, 1> wrongly_turned{{{.max_torque = 100, .max_torsional_stiffness = -1}}};
    EXPECT_THROW(model.couple_to(wrongly_turned), InvalidInput);
}

TEST(HapticModel, only_a_device_that_renders_torque_limits_what_turns_the_tool) {
    HapticModel model(plate());
    const double asked = ToolSettings{}.torsional_stiffness;
    EXPECT_EQ(model.torsional_coupling(), asked);
    const std::array<DeviceLimits, 1> without{{{.max_torsional_stiffness = 30, .torsional_damping = 0.01}}};
    model.couple_to(without);
    EXPECT_EQ(model.torsional_coupling(), asked);
    const std::array<DeviceLimits, 2> with{{{.max_torque = 100, .max_torsional_stiffness = 300},
                                            {.max_torque = 100, .torsional_damping = 0.11}}};
    model.couple_to(with);
    EXPECT_DOUBLE_EQ(model.torsional_coupling(), 220);
}

TEST(HapticModel, a_rigid_plate_and_a_fixed_foot_are_as_stiff_as_the_coupling) {
    for (const double stiffness : {0.05, 0.5, 3.0})
        for (const double depth : {0.01, 0.3, 1.0}) {
            Case hard = plate(), held = soft_cube(2);
            hard.haptics.coupling_stiffness = held.haptics.coupling_stiffness = stiffness;
            TickResult result{};
            HapticModel on_plate(hard), on_fixed(held);
            on_plate.tick(held_at({0.3, 0.4, 5}), result);
            on_plate.tick(held_at({0.3, 0.4, 1 - depth}), result);
            EXPECT_NEAR(force_of(result).z(), stiffness * depth, stiffness * clearance);
            EXPECT_NEAR(force_of(result).head<2>().norm(), 0, stiffness * clearance);
            // The cube is held at z = 0; the tool comes from below.
            on_fixed.tick(held_at({10.4, 9.3, -5}), result);
            on_fixed.tick(held_at({10.4, 9.3, depth - 1}), result);
            EXPECT_NEAR(force_of(result).z(), -stiffness * depth, stiffness * clearance);
            EXPECT_NEAR(force_of(result).head<2>().norm(), 0, stiffness * clearance);
        }
}

TEST(HapticModel, no_body_is_felt_stiffer_than_the_coupling) {
    Case c = soft_cube(5);
    c.rigid_bodies.push_back(rigid("skull", sample::sphere_surface({38, 10, 10}, 15, 3)));
    HapticModel model(c);
    const std::array<const collision::CollisionSurface*, 2> surfaces{&model.surface(0), &model.surface(1)};
    GodObject undeformed(c.haptics.tool_radius, 2);
    TickResult result{};
    int solved = 0;
    for (int tick = 0; tick < 20000; ++tick) {
        const double t = 1e-3 * tick;
        const Vector3d device(20 + 18 * std::sin(1.1 * t), 10 + 9 * std::sin(2.3 * t + 1),
                              19 + 7 * std::cos(5.1 * t));
        model.tick(held_at(device), result);
        undeformed.move(surfaces, device);
        const double reach = (undeformed.position() - device).norm();
        ASSERT_LE(force_of(result).norm(), model.coupling() * (reach + clearance)) << tick;
        solved += result.body == 1;
    }
    EXPECT_GT(solved, 1000);
}

class StillDevice : public Device {
  public:
    std::string name() const override { return "still"; }
    DeviceLimits limits() const override { return {.max_force = 3, .max_stiffness = 0.2}; }
    DeviceState read(double time) noexcept override {
        DeviceState state = held_at({0, 0, 30});
        state.time = time;
        return state;
    }
    void write(const Wrench&) noexcept override {}
};

TEST(ServoLoop, takes_one_device_for_each_tool_and_couples_to_what_they_bear) {
    StillDevice device;
    const std::array<Device*, 2> two{&device, &device};
    HapticModel model(plate(), "continuous", 2);
    EXPECT_THROW(ServoLoop(model, device), InvalidInput);
    EXPECT_THROW(ServoLoop(model, std::span<Device* const>{}), InvalidInput);
    const ServoLoop loop(model, two);
    EXPECT_EQ(model.coupling(), 0.2);
    HapticModel one(plate());
    EXPECT_THROW(ServoLoop(one, two), InvalidInput);
}

TEST(HapticModel, published_schemes_refuse_two_tools) {
    for (const std::string_view scheme : {"single", "twice"}) {
        EXPECT_THROW(HapticModel(soft_cube(2), scheme, 2), InvalidInput);
        EXPECT_NO_THROW(HapticModel(soft_cube(2), scheme, 1));
    }
}

}  // namespace
}  // namespace palpate
