// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <vector>

#include "runtime/haptics/contact/creep.hpp"
#include "runtime/haptics/drawn_creep.hpp"
#include "tests/runtime/allocation_trap.hpp"
#include "tests/runtime/haptics/held_tool.hpp"

namespace palpate {
namespace {

using namespace haptics;
using Eigen::Vector3d;
using Terms = std::vector<RelaxationTerm>;

constexpr double period = 1e-3;  // s

// E(t) / E.
double modulus_after(const Terms& terms, double time) {
    double left = 1;
    for (const RelaxationTerm& term : terms) left -= term.share * (1 - std::exp(-time / term.time));
    return left;
}

TEST(Creep, of_one_term_is_the_standard_solids) {
    const auto creep = creep_of(Terms{{0.3, 2}});
    ASSERT_EQ(creep.size(), 1U);
    EXPECT_DOUBLE_EQ(creep[0].time, 2 / 0.7);
    EXPECT_NEAR(creep[0].share, 0.3 / 0.7, 1e-15);
    EXPECT_TRUE(creep_of({}).empty());
}

// s E(s) s C(s) = 1 for every s is what makes them the two sides of one material.
TEST(Creep, and_relaxation_are_reciprocal_when_transformed) {
    for (const Terms& terms :
         {Terms{{0.3, 1}}, Terms{{0.2, 0.03}, {0.35, 0.27}},
          Terms{{0.01, 1e-3}, {0.5, 1}, {0.2, 1.001}, {0.2, 1e3}}, Terms{{0.9, 0.1}, {0.0999, 10}}}) {
        const std::vector<CreepTerm> creep = creep_of(terms);
        ASSERT_EQ(creep.size(), terms.size());
        for (std::size_t k = 0; k < creep.size(); ++k) {
            EXPECT_GT(creep[k].share, 0);
            EXPECT_GT(creep[k].time, terms[k].time);
            if (k + 1 < terms.size()) {
                EXPECT_LT(creep[k].time, terms[k + 1].time);
            }
        }
        for (double s = 1e-4; s < 1e4; s *= 3) {
            double modulus = 1, compliance = 1;
            for (const auto& [share, time] : terms) modulus -= share / (1 + s * time);
            for (const auto& [share, time] : creep) compliance += share / (1 + s * time);
            // Nearly equal times leave a few digits less of the zero between them.
            EXPECT_NEAR(modulus * compliance, 1, 1e-9) << s;
        }
    }
}

// The true elastic cube, [0, 20] mm, held below, under a tool of 3 mm on a coupling so stiff that the tool is
// where the device is.
class CreepingCube : public ::testing::Test {
  protected:
    static constexpr double stiff = 20;  // N/mm, some hundred times the cube's

    static Case cube(const Terms& terms, double coupling = stiff) {
        Case c;
        c.name = "cube";
        c.deformable_bodies.push_back(sample::true_elastic_cube(5));
        for (const Label& region : c.deformable_bodies[0].mesh.region_names)
            for (const RelaxationTerm& term : terms)
                c.deformable_bodies[0].relaxation.push_back({region.value, term});
        c.haptics = {.tool_radius = 3, .coupling_stiffness = coupling, .max_force = 99, .max_force_rate = 99};
        return c;
    }

    static TickResult go(HapticModel& model, const Vector3d& p) {
        TickResult result{};
        model.tick(held_at(p), result);
        return result;
    }
    // The work of the hand on a straight way, N mm.
    static double walk(HapticModel& model, const Vector3d& from, const Vector3d& to, int ticks) {
        double work = 0;
        Vector3d last = force_of(go(model, from));
        for (int k = 1; k <= ticks; ++k) {
            const Vector3d force = force_of(go(model, from + (to - from) * k / ticks));
            work -= 0.5 * (force + last).dot(to - from) / ticks;
            last = force;
        }
        return work;
    }

    static inline const Vector3d above{10.3, 9.4, 26}, surface{10.3, 9.4, 23}, pressed{10.3, 9.4, 21};
};

TEST_F(CreepingCube, a_press_that_is_held_relaxes_along_the_series) {
    for (const Terms& terms : {Terms{{0.4, 0.5}}, Terms{{0.2, 0.05}, {0.3, 0.6}}}) {
        const Case c = cube(terms);
        HapticModel model(c);
        go(model, above);
        const double first = force_of(go(model, pressed)).z();
        ASSERT_GT(first, 0.03);
        for (int tick = 1; tick < 6000; ++tick) {
            const TickResult result = go(model, pressed);
            ASSERT_EQ(result.status, tick_ok);
            if (tick % 100 != 0) continue;
            // A tick counts as a whole and the coupling gives way a little: within one per cent.
            EXPECT_NEAR(force_of(result).z(), first * modulus_after(terms, tick * period),
                        0.01 * first * modulus_after(terms, tick * period))
                << tick;
        }
    }
}

// Where the tool is held, so is the surface: what earlier contacts left is what the present ones lack.
TEST_F(CreepingCube, is_drawn_where_it_is) {
    const Case c = cube({{0.2, 0.05}, {0.3, 0.6}});
    HapticModel model(c);
    DrawnCreep drawn(c.deformable_bodies[0]);
    TickResult result = go(model, above);
    std::vector<Eigen::Vector3f> u(c.deformable_bodies[0].boundary.nodes.size()), first;
    for (int tick = 0; tick < 3000; ++tick) {
        result = go(model, pressed);
        model.surface_displacement(0, result, u);
        if (tick == 0) first = u;
        if (tick % 16 != 0) continue;  // as often as a picture is drawn
        drawn.follow(tick * period, u);
        for (std::size_t v = 0; v < u.size(); ++v)
            ASSERT_NEAR((u[v] - first[v]).norm(), 0, 0.02 * first[v].norm() + 1e-3) << tick << " " << v;
    }
    model.surface_displacement(0, result, u);
    const auto deepest = std::ranges::max_element(first, {}, [](const auto& d) { return d.norm(); });
    EXPECT_LT(u[static_cast<std::size_t>(deepest - first.begin())].norm(), 0.6F * deepest->norm());
}

TEST_F(CreepingCube, forgets_after_twelve_times_the_longest_time_of_its_creep) {
    EXPECT_EQ(HapticModel(cube({})).memory_ticks(), 0);
    EXPECT_EQ(HapticModel(cube({{0.5, 0.2}})).memory_ticks(), 4800);
    EXPECT_EQ(HapticModel(cube({{0.5, 0.2}}), "single").memory_ticks(), 0);
}

// Half of the cube relaxes quickly, the other slowly: what lies between them does not creep, and nothing
// comes out of a way over both.
TEST_F(CreepingCube, of_two_kinds_loses_energy_too) {
    Case c = cube({}, 0.5);
    DeformableBody& body = c.deformable_bodies[0];
    for (std::size_t t = 0; t < body.mesh.tetrahedra.size(); ++t) {
        double x = 0;
        for (const std::int32_t node : body.mesh.tetrahedra[t])
            x += body.mesh.rest_positions[static_cast<std::size_t>(node)].x() / 4;
        body.mesh.regions[t] = x < 10 ? 1 : 2;
    }
    body.relaxation = {{1, {0.5, 0.02}}, {2, {0.4, 0.5}}};
    HapticModel model(c);
    const Vector3d a(7, 8, 23.5), b(7, 8, 20.5), d(13, 11, 20.5), e(13, 11, 23.5);
    go(model, a + Vector3d(0, 0, 3));
    double most = 0;
    for (int round = 0; round < 4; ++round) {
        const double in = walk(model, a, b, 100), along = walk(model, b, d, 100),
                     out = walk(model, d, e, 100), back = walk(model, e, a, 100);
        most = std::max(most, in);
        EXPECT_GT(in + along + out + back, -1e-3 * most) << round;
    }
}

TEST_F(CreepingCube, a_quick_press_feels_as_without_relaxation) {
    const Case c = cube({{0.4, 0.5}}), elastic = cube({});
    HapticModel model(c), twin(elastic);
    go(model, above);
    go(twin, above);
    // In the first tick, 1 ms of 0.5 s passes.
    const double force = force_of(go(twin, pressed)).z();
    EXPECT_NEAR(force_of(go(model, pressed)).z(), force, 0.003 * force);
}

TEST_F(CreepingCube, feels_bit_for_bit_the_same_where_only_what_is_not_at_its_surface_relaxes) {
    const Case elastic = cube({});
    Case c = elastic;
    c.deformable_bodies[0].relaxation = {{2, {0.4, 0.5}}};  // the tumour in the middle
    HapticModel model(c), twin(elastic);
    for (int tick = 0; tick < 2000; ++tick) {
        const double s = 0.004 * tick;
        const Vector3d p(10 + 5 * std::sin(s), 9 + 4 * std::cos(1.7 * s), 23 - 2.5 * std::sin(2.3 * s));
        const TickResult a = go(model, p), b = go(twin, p);
        ASSERT_EQ(a.force, b.force) << tick;
        ASSERT_EQ(a.contact_count, b.contact_count) << tick;
    }
}

TEST_F(CreepingCube, a_dent_is_left_and_recovers) {
    const Case c = cube({{0.4, 0.2}});
    HapticModel model(c);
    go(model, above);
    const double first = force_of(go(model, pressed)).z();
    for (int tick = 0; tick < 1000; ++tick) go(model, pressed);
    // Back by half at once: the surface is not there yet.
    const Vector3d half = surface - Vector3d(0, 0, 0.5);
    TickResult result = go(model, half);
    EXPECT_EQ(force_of(result).norm(), 0);
    EXPECT_EQ(result.status, tick_ok);
    // It comes, and in the end the tool is pressed as on fresh tissue, relaxed.
    double last = 0;
    for (int tick = 0; tick < 3000; ++tick) {
        result = go(model, half);
        EXPECT_EQ(result.status, tick_ok) << tick;
        EXPECT_GE(force_of(result).z(), last - 1e-4) << tick;
        last = force_of(result).z();
    }
    HapticModel fresh(c);
    go(fresh, above);
    for (int tick = 0; tick < 3000; ++tick) result = go(fresh, half);
    EXPECT_NEAR(last, force_of(result).z(), 0.01 * last);
    // Left alone for long, it is as it was.
    for (int tick = 0; tick < 6000; ++tick) go(model, above);
    EXPECT_EQ(force_of(go(model, pressed)).z(), first);
}

TEST_F(CreepingCube, meets_a_tool_that_comes_back_lower_than_at_first) {
    const Case c = cube({{0.4, 0.5}});
    HapticModel model(c);
    go(model, above);
    const double first = force_of(go(model, pressed)).z();
    for (int tick = 0; tick < 1000; ++tick) go(model, pressed);
    for (int tick = 0; tick < 50; ++tick) go(model, above);
    const double again = force_of(go(model, pressed)).z();
    EXPECT_LT(again, 0.95 * first);
    EXPECT_GT(again, 0.6 * first);
}

// Presses, slides and comes back where it was pressed before, at all speeds: nothing comes out of it.
TEST_F(CreepingCube, a_closed_way_loses_energy_and_never_gives_any) {
    for (const Terms& terms : {Terms{{0.4, 0.1}}, Terms{{0.3, 0.02}, {0.4, 0.5}}})
        for (const int ticks : {20, 100, 500}) {
            const Case c = cube(terms, 0.5);
            HapticModel model(c);
            const Vector3d a(9, 8, 23.5), b(9, 8, 20.5), d(12, 11, 20.5), e(12, 11, 23.5);
            go(model, a + Vector3d(0, 0, 3));
            double most = 0, sum = 0;
            for (int round = 0; round < 4; ++round) {
                const double in = walk(model, a, b, ticks), wait = walk(model, b, b, 3 * ticks);
                const double along = walk(model, b, d, ticks), out = walk(model, d, e, ticks);
                const double back = walk(model, e, a, ticks);
                EXPECT_EQ(wait, 0);
                most = std::max(most, in);
                sum += in + along + out + back;
                // Of one round: relaxed at b, it goes out at d; what a search may leave is a per mille.
                EXPECT_GT(in + along + out + back, -1e-3 * most) << ticks << " " << round;
            }
            EXPECT_GT(sum, 0.02 * most) << ticks;
        }
}

TEST_F(CreepingCube, reset_forgets_and_the_same_way_gives_the_same_bits) {
    const Case c = cube({{0.4, 0.5}, {0.2, 3}});
    HapticModel model(c);
    const auto run = [&] {
        std::vector<std::array<double, 3>> forces;
        for (int tick = 0; tick < 1500; ++tick) {
            const double s = 0.004 * tick;
            forces.push_back(
                go(model, {10 + 5 * std::sin(s), 9 + 4 * std::cos(1.7 * s), 24 - 3 * std::sin(2.3 * s)})
                    .force);
        }
        return forces;
    };
    const auto first = run();
    model.reset();
    EXPECT_EQ(run(), first);
}

TEST_F(CreepingCube, allocates_nothing_where_all_of_a_surface_was_pressed) {
    Case c = cube({{0.4, 100}}, 0.5);
    c.deformable_bodies[0] = sample::true_elastic_cube(8);  // 386 vertices, more than are remembered
    for (const Label& region : c.deformable_bodies[0].mesh.region_names)
        c.deformable_bodies[0].relaxation.push_back({region.value, {0.4, 100}});
    HapticModel model(c);
    go(model, {1, 1, 30});
    TickResult result{};
    std::uint32_t seen = 0;
    const AllocationTrap trap;
    for (int tick = 0; tick < 20000; ++tick) {
        const double s = 1e-3 * tick;
        model.tick(held_at({10 + 9 * std::sin(1.1 * s), 10 + 9 * std::sin(7.3 * s), 21.5}), result);
        seen |= result.status;
    }
    EXPECT_EQ(trap.count(), 0U);
    EXPECT_EQ(seen, tick_ok);
}

}  // namespace
}  // namespace palpate
