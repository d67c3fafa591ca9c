// SPDX-License-Identifier: Apache-2.0
// What was touched before leaves no trace in what is touched next: not in one bit of the force.
#include <cstring>
#include <gtest/gtest.h>
#include <random>

#include "tests/runtime/haptics/held_tool.hpp"
#include "tests/runtime/samples.hpp"

namespace palpate {
namespace {

using namespace realtime;
using Eigen::Vector3d;

Case soft_and_hard() {
    Case c = soft_cube(6);
    c.rigid_bodies.push_back(rigid("ball", sample::sphere_surface({32, 10, 12}, 8, 4)));
    c.haptics.tool_radius = 4;  // many points at once
    c.haptics.friction_at_rest = 0.3;
    c.haptics.friction_sliding = 0.2;
    return c;
}

// Down from a random place above both bodies within a few ticks, along, and up again.
std::vector<DeviceState> push(std::mt19937& random) {
    const auto between = [&](double a, double b) {
        return std::uniform_real_distribution<double>(a, b)(random);
    };
    const Vector3d above(between(-1, 38), between(-1, 21), 40),
        below(above[0] + between(-3, 3), above[1], between(17, 25));
    const Vector3d along = below + Vector3d(between(-4, 4), between(-4, 4), between(-1, 1));
    std::vector<DeviceState> states(3, held_at(above));
    const int way = std::uniform_int_distribution<int>(2, 12)(random);
    for (int i = 1; i <= way; ++i) states.push_back(held_at(above + i * (below - above) / way));
    for (int i = 1; i <= 8; ++i) states.push_back(held_at(below + i * (along - below) / 8));
    for (int i = 0; i < 8; ++i) states.push_back(held_at(along));
    for (int i = 1; i <= 8; ++i) states.push_back(held_at(along + i * (above - along) / 8));
    for (int i = 0; i < 12; ++i) states.push_back(held_at(above));
    return states;
}

TEST(FreshContact, has_the_force_that_it_would_have_had_without_the_ones_before) {
    haptics::HapticModel experienced(soft_and_hard()), fresh(soft_and_hard());
    std::mt19937 random(11);
    std::size_t most_contacts = 0, pressed = 0;
    for (int contact = 0; contact < samples_of(400); ++contact) {
        fresh.reset();
        TickResult expected{}, found{};
        for (const DeviceState& state : push(random)) {
            fresh.tick(state, expected);
            experienced.tick(state, found);
            ASSERT_EQ(std::memcmp(found.force.data(), expected.force.data(), sizeof(found.force)), 0)
                << "push " << contact << ": " << (force_of(found) - force_of(expected)).norm() << " N";
            most_contacts = std::max(most_contacts, found.active_contacts().size());
            pressed += force_of(found).norm() > 0;
        }
        ASSERT_EQ(force_of(found).norm(), 0);
    }
    EXPECT_GT(most_contacts, 2U);
    EXPECT_GT(pressed, static_cast<std::size_t>(samples_of(4000)));
}

}  // namespace
}  // namespace palpate
