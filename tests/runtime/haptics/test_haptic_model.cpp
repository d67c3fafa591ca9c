// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstring>
#include <functional>
#include <gtest/gtest.h>
#include <limits>
#include <memory>
#include <utility>

#include "formats/model/errors.hpp"
#include "runtime/haptics/haptic_model.hpp"
#include "runtime/haptics/methods/contact_methods.hpp"
#include "tests/formats/sample_case.hpp"
#include "tests/runtime/allocation_trap.hpp"
#include "tests/runtime/elastic_cube.hpp"
#include "tests/runtime/haptics/held_tool.hpp"

namespace palpate {
namespace {

using namespace haptics;
using namespace realtime;
using Eigen::Vector3d;

DeviceState at(const Vector3d& p) {
    DeviceState state;
    state.position = {p[0], p[1], p[2]};
    return state;
}

// A skull and a true elastic wall beside it.
Case patient() {
    Case c = sample::sample_case();
    c.deformable_bodies = {sample::true_elastic_cube(3)};
    return c;
}

// A hand that wanders over and into both bodies.
Vector3d wandering(int tick) {
    const double t = 1e-3 * tick;
    return {20 + 18 * std::sin(1.1 * t), 10 + 9 * std::sin(2.3 * t + 1), 19 + 7 * std::cos(5.1 * t)};
}

TEST(HapticModel, a_rigid_body_answers_with_the_coupling) {
    HapticModel model(patient());
    TickResult result{};
    model.tick(at({40, 10, 30}), result);
    EXPECT_EQ(force_of(result).norm(), 0);
    EXPECT_EQ(result.body, -1);
    // The skull's top is at z = 25; the tool of 1.5 mm rests at 26.5.
    for (int tick = 0; tick < 20; ++tick) model.tick(at({40, 10, 24.5}), result);
    EXPECT_NEAR(force_of(result).z(), 0.4 * 2, 0.4 * 0.05);  // the facets' sag
    EXPECT_EQ(result.body, 0);
    EXPECT_NEAR(result.tool_position[2], 26.5, 0.05);
    EXPECT_EQ(result.contacts[0].body, 0);
    EXPECT_NEAR(result.contacts[0].force, 0.8, 0.02);
}

TEST(HapticModel, a_tick_never_allocates) {
    const auto model = std::make_unique<HapticModel>(patient());
    TickResult result{};
    model->tick(at({20, 10, 60}), result);
    int touching = 0;
    std::size_t allocated = 0;
    {
        const AllocationTrap trap;
        for (int tick = 0; tick < 100000; ++tick) {
            model->tick(at(wandering(tick)), result);
            touching += result.contact_count > 0;
        }
        allocated = trap.count();
    }
    EXPECT_EQ(allocated, 0U);
    EXPECT_GT(touching, 20000);
}

TEST(HapticModel, the_trap_sees_an_allocation) {
    const AllocationTrap trap;
    void* volatile memory = ::operator new(1);  // called as a function, it is not optimised away
    EXPECT_EQ(trap.count(), 1U);
    ::operator delete(memory);
}

TEST(HapticModel, forces_stay_within_the_limits) {
    Case c = patient();
    c.haptics.max_force_rate = 0.02;
    HapticModel model(c);
    TickResult result{};
    model.tick(at({20, 10, 60}), result);
    Vector3d last = Vector3d::Zero();
    std::uint32_t seen = tick_ok;
    int unsolved = 0;
    for (int tick = 0; tick < 6000; ++tick) {
        model.tick(at(wandering(tick) - Vector3d(0, 0, 2)), result);
        const Vector3d force = force_of(result);
        ASSERT_LE(force.norm(), 3.0 + 1e-9);
        ASSERT_LE((force - last).norm(), 0.02 + 1e-9);
        last = force;
        seen |= result.status;
        unsolved += (result.status & contact_unsolved) != 0;
    }
    EXPECT_TRUE(seen & force_limited);
    EXPECT_TRUE(seen & rate_limited);
    EXPECT_LT(unsolved, 60);  // 1 %: the hand goes 12 mm deep into a cube of 20 mm
}

TEST(HapticModel, a_position_that_is_not_a_number_ramps_the_force_to_zero_and_says_so) {
    HapticModel model(patient());
    TickResult result{};
    model.tick(at({40, 10, 30}), result);
    for (int tick = 0; tick < 20; ++tick) model.tick(at({40, 10, 23}), result);
    ASSERT_GT(force_of(result).norm(), 1);
    DeviceState bad = at({40, std::numeric_limits<double>::quiet_NaN(), 23});
    DeviceState gone = at({40, 10, 23});
    gone.faults = device_lost;
    for (int tick = 0; tick < 20; ++tick) {
        model.tick(tick % 2 ? bad : gone, result);
        EXPECT_EQ(result.faults, tick % 2 ? invalid_position : device_lost);
        EXPECT_TRUE(force_of(result).allFinite());
    }
    EXPECT_EQ(force_of(result).norm(), 0);
    const int back = ForceLimiter::ramp_ticks + ForceLimiter::return_ticks;
    for (int tick = 0; tick < back; ++tick) model.tick(at({40, 10, 23}), result);
    EXPECT_GT(force_of(result).norm(), 1);
    EXPECT_EQ(result.faults, no_fault);
}

TEST(HapticModel, a_device_that_was_lost_and_found_elsewhere_feels_no_old_contact) {
    for (const std::string_view scheme : {"single", "twice"}) {
        HapticModel model(patient(), scheme);
        TickResult result{};
        model.tick(at({40, 10, 24}), result);
        model.detect();
        model.tick(at({40, 10, 24}), result);
        ASSERT_GT(force_of(result).norm(), 0.1);
        DeviceState gone = at({40, 10, 24});
        gone.faults = device_lost;
        for (int tick = 0; tick < 20; ++tick) model.tick(gone, result);
        model.tick(at({40, 10, 60}), result);
        EXPECT_EQ(force_of(result).norm(), 0);
    }
}

// Free above the skull, then free below it, whatever lies between.
double force_after_a_way_unseen(std::uint32_t fault) {
    HapticModel model(patient());
    TickResult result{};
    model.tick(at({40, 10, 40}), result);
    DeviceState gone = at({40, 10, 40});
    gone.faults = fault;
    for (int tick = 0; tick < 100; ++tick) model.tick(gone, result);
    const DeviceState below = at({40, 10, -40});
    const int back = ForceLimiter::ramp_ticks + ForceLimiter::return_ticks;
    for (int tick = 0; tick < back; ++tick) model.tick(below, result);
    EXPECT_EQ(result.faults, no_fault);
    return force_of(result).norm();
}

TEST(HapticModel, a_device_found_again_beyond_a_body_is_not_pulled_back_through_it) {
    EXPECT_EQ(force_after_a_way_unseen(device_lost), 0);
    // The same way seen is one through the bone.
    EXPECT_GT(force_after_a_way_unseen(no_fault), 1);
}

TEST(HapticModel, the_force_keeps_to_what_the_device_bears) {
    HapticModel model(patient());
    const DeviceLimits weak{.max_force = 0.3};
    model.couple_to({&weak, 1});
    TickResult result{};
    model.tick(at({40, 10, 30}), result);
    for (int tick = 0; tick < 20; ++tick) model.tick(at({40, 10, 22}), result);
    EXPECT_NEAR(force_of(result).norm(), 0.3, 1e-12);
    EXPECT_TRUE(result.status & force_limited);
}

TEST(HapticModel, the_same_path_gives_the_same_bytes) {
    const auto run = [] {
        HapticModel model(patient());
        std::vector<std::array<double, 3>> forces;
        TickResult result{};
        model.tick(at({20, 10, 60}), result);
        for (int tick = 0; tick < 3000; ++tick) {
            model.tick(at(wandering(tick)), result);
            forces.push_back(result.force);
        }
        return forces;
    };
    EXPECT_EQ(run(), run());
}

TEST(HapticModel, refuses_settings_and_cases_that_cannot_be_felt) {
    const auto refused = [](const std::function<void(Case&)>& spoil) {
        Case c = sample::sample_case();
        spoil(c);
        EXPECT_THROW(HapticModel{c}, InvalidInput);
    };
    refused([](Case& c) { c.haptics.tool_radius = 0; });
    refused([](Case& c) { c.haptics.coupling_stiffness = -1; });
    refused([](Case& c) { c.haptics.max_force = std::nan(""); });
    refused([](Case& c) { c.haptics.max_force_rate = 0; });
    refused([](Case& c) {
        c.rigid_bodies.clear();
        c.deformable_bodies.clear();
    });
}

TEST(HapticModel, refuses_settings_of_a_tool_that_make_no_sense_whatever_the_method) {
    const double nan = std::nan("");
    for (const ContactMethodEntry& method : contact_methods()) {
        for (const auto& [settings, option] :
             {std::pair{ToolSettings{.torsional_stiffness = 0}, "--torsional-stiffness"},
              {ToolSettings{.torsional_stiffness = nan}, "--torsional-stiffness"},
              {ToolSettings{.max_torque = -1}, "--max-torque"},
              {ToolSettings{.max_torque_rate = 0}, "--max-torque-rate"},
              {ToolSettings{.shell_points = 3}, "--shell-points"}}) {
            Case c = patient();
            c.tool = ToolBody{.surface = {}, .settings = settings};
            try {
                const HapticModel model(c, method.name);
                ADD_FAILURE() << "taken by " << method.name << ": " << option;
            } catch (const InvalidInput& error) {
                EXPECT_EQ(error.detail().culprit, option) << method.name;
            }
        }
    }
}

}  // namespace
}  // namespace palpate
