// SPDX-License-Identifier: Apache-2.0
// What holds for every line of the table of contact methods.
#include <algorithm>
#include <gtest/gtest.h>
#include <set>
#include <string>

#include "formats/model/errors.hpp"
#include "tests/runtime/allocation_trap.hpp"
#include "tests/runtime/haptics/held_tool.hpp"

namespace palpate {
namespace {

using namespace haptics;

Case plate_and_cube() {
    Case c = soft_cube(2);
    c.rigid_bodies.push_back(rigid("plate", box({-40, -20, -10}, {-10, 20, 0})));
    return c;
}

class EveryMethod : public testing::TestWithParam<ContactMethodEntry> {};

TEST_P(EveryMethod, is_found_by_its_name_and_says_what_it_does) {
    EXPECT_EQ(find_contact_method(GetParam().name).name, GetParam().name);
    EXPECT_NE(contact_method_sentences().find(GetParam().sentence), std::string::npos);
    EXPECT_FALSE(GetParam().sentence.empty());
    EXPECT_EQ(HapticModel(plate(), GetParam().name).method().name, GetParam().name);
}

TEST_P(EveryMethod, knows_the_radius_it_says_it_knows) {
    const HapticModel model(plate(), GetParam().name);
    EXPECT_EQ(model.contact_radius(), GetParam().can.has_radius ? model.settings().tool_radius : 0);
}

TEST_P(EveryMethod, takes_as_many_tools_as_it_says_and_no_more) {
    const std::size_t most = std::min<std::size_t>(GetParam().can.most_tools, 3);
    EXPECT_EQ(HapticModel(plate_and_cube(), GetParam().name, most).tool_count(), most);
    if (GetParam().can.most_tools > most) return;
    EXPECT_THROW(HapticModel(plate_and_cube(), GetParam().name, most + 1), InvalidInput);
}

// Pressed into plate and cube, lost, found again far off, and pressed once more.
TEST_P(EveryMethod, feels_bodies_and_nothing_while_the_device_is_lost_and_allocates_nothing) {
    HapticModel model(plate_and_cube(), GetParam().name);
    TickResult result{};
    double felt = 0, felt_lost = 0;
    std::size_t allocated = 0;
    for (const double x : {-25.0, 10.0}) {
        if (x > 0 && !GetParam().can.feels_tissue) continue;
        const double top = x < 0 ? 0 : 20;
        for (int tick = 0; tick < 1500; ++tick) {
            const double depth = tick < 100 || tick > 1400 ? -3 : 1;
            realtime::DeviceState state = held_at({x, 9, top - depth});
            const bool lost = tick > 300 && tick < 400;
            if (lost) state.faults = device_lost;
            const AllocationTrap trap;
            model.tick(state, result);
            if (tick % 33 == 0) model.detect();
            allocated += trap.count();
            if (lost && tick > 300 + ForceLimiter::ramp_ticks)
                felt_lost = std::max(felt_lost, force_of(result).norm());
            else
                felt = std::max(felt, force_of(result).norm());
            if (tick == 250) {
                EXPECT_GT(force_of(result).z(), 0.01) << x;
                EXPECT_GE(result.body, 0);
                EXPECT_GT(result.depth, 0);
                EXPECT_EQ(result.body, x < 0 ? 0 : 1);
            }
        }
        EXPECT_EQ(force_of(result).norm(), 0) << x;
    }
    EXPECT_EQ(allocated, 0);
    EXPECT_GT(felt, 0.01);
    EXPECT_EQ(felt_lost, 0);
}

TEST_P(EveryMethod, detects_only_where_it_says_it_needs_to) {
    HapticModel model(plate(), GetParam().name);
    TickResult result{};
    model.tick(held_at({0, 0, 3}), result);
    for (int tick = 0; tick < 40; ++tick) {  // no detection comes
        model.tick(held_at({0, 0, 3 - 0.1 * tick}), result);
        EXPECT_EQ(result.detected_tick, -1);
    }
    EXPECT_EQ(force_of(result).norm() > 0, model.detects() == Detects::nothing);
    model.detect();
    model.tick(held_at({0, 0, -1}), result);
    EXPECT_EQ(result.detected_tick >= 0, model.detects() != Detects::nothing);
    EXPECT_GT(force_of(result).norm(), 0);
}

TEST_P(EveryMethod, gives_the_same_forces_again_after_a_reset) {
    HapticModel model(plate_and_cube(), GetParam().name);
    const Eigen::Vector3d start =
        GetParam().can.feels_tissue ? Eigen::Vector3d(10, 9, 22) : Eigen::Vector3d(-25, 9, 2);
    const auto run = [&] {
        std::vector<std::array<double, 3>> forces;
        TickResult result{};
        for (int tick = 0; tick < 200; ++tick) {
            model.tick(held_at(start + Eigen::Vector3d(0.01 * tick, 0, -0.02 * tick)), result);
            if (tick % 33 == 32) model.detect();
            forces.push_back(result.force);
        }
        return forces;
    };
    const auto first = run();
    model.reset();
    EXPECT_EQ(run(), first);
    EXPECT_GT(first.back()[2], 0);
}

INSTANTIATE_TEST_SUITE_P(ContactMethods, EveryMethod,
                         testing::ValuesIn(contact_methods().begin(), contact_methods().end()),
                         [](const auto& info) {
                             std::string name(info.param.name);
                             std::ranges::replace(name, '-', '_');
                             return name;
                         });

TEST(ContactMethods, have_names_of_their_own) {
    std::set<std::string_view> names;
    for (const ContactMethodEntry& method : contact_methods()) names.insert(method.name);
    EXPECT_EQ(names.size(), contact_methods().size());
    EXPECT_TRUE(names.contains(usual_contact_method));
}

TEST(ContactMethods, an_unknown_name_is_answered_with_the_known_ones) {
    try {
        find_contact_method("thrice", "--scheme");
        FAIL() << "found";
    } catch (const UsageError& error) {
        EXPECT_EQ(std::string(error.what()), "--scheme: thrice (expected " + contact_method_names() + ")");
    }
}

TEST(ContactMethods, are_named_that_take_so_many_tools) {
    EXPECT_TRUE(contact_method_names().starts_with("single, twice"));
    const std::string of_two = contact_method_names(2);
    for (const ContactMethodEntry& method : contact_methods())
        EXPECT_EQ(of_two.find(method.name) != std::string::npos, method.can.most_tools >= 2) << method.name;
}

}  // namespace
}  // namespace palpate
