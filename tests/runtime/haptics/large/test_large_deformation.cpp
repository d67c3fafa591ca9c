// SPDX-License-Identifier: Apache-2.0
// Tissue that is neo-Hookean beside the tick: where the hand rests it is that of the equilibrium, whatever
// the tick makes of it meanwhile.
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <vector>

#include "formats/hyperelasticity/equilibrium.hpp"
#include "formats/model/arrays.hpp"
#include "formats/model/errors.hpp"
#include "runtime/haptics/contact/contact_bodies.hpp"
#include "tests/runtime/allocation_trap.hpp"
#include "tests/runtime/haptics/held_tool.hpp"

namespace palpate {
namespace {

using namespace haptics;
using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr int ticks_per_answer = 10;
// What the search leaves out that ends at steps of 1e-4 mm, with what float32 does to fields: of the whole.
constexpr double search_error = 1e-3;
// Of what is of the second order: the linear answer to a press of a hundredth of the cube's height.
constexpr double second_order = 0.01;
// Of the force, and of the energy stored: what a hand may feel of answers that come in.
constexpr double most_step = 0.03, most_work = 0.01;
// By so much at least linear tissue is wrong, pressed by a fifth of the cube's height (surface), and too
// soft.
constexpr double linear_error = 0.03;

Case far_cube(int cells, double friction = 0) {
    Case c = soft_cube(cells);
    c.hyperelastic = {c.deformable_bodies[0].name};
    c.haptics.tool_radius = 4;
    c.haptics.friction_at_rest = c.haptics.friction_sliding = friction;
    return c;
}

// A model whose loop runs beside it, as in virtual time.
struct Felt {
    explicit Felt(const Case& patient_case)
        : model(patient_case), vertices(patient_case.deformable_bodies[0].boundary.nodes.size()) {}

    const TickResult& at(const Vector3d& p) {
        const Vector3d before = force_of(result), from = vector_of(result.device_position);
        model.tick(held_at(p), result);
        if (ticks > 0) work += (force_of(result) + before).dot(p - from) / 2;
        if (++ticks % ticks_per_answer == 0 && answers) model.detect();
        return result;
    }
    const TickResult& rest(const Vector3d& p, int count) {
        for (int tick = 0; tick < count; ++tick) at(p);
        return result;
    }
    // Along a straight line, 10 mm/s.
    const TickResult& go(const Vector3d& from, const Vector3d& to) {
        const int count = static_cast<int>(std::ceil((to - from).norm() / 0.01));
        for (int tick = 1; tick <= count; ++tick) at(from + (to - from) * tick / count);
        return result;
    }
    std::vector<Vector3f> drawn() {
        std::vector<Vector3f> moved(vertices);
        const TickResult* const told = &result;
        model.surface_displacement(0, result, moved);
        model.add_beyond(0, {&told, 1}, moved);
        return moved;
    }

    HapticModel model;
    std::size_t vertices;  // of the cube's surface
    TickResult result;
    int ticks = 0;
    bool answers = true;  // of the loop
    double work = 0;      // of the forces on the hand, N mm
};

// Where the equilibrium itself has the surface under a tick's contacts.
std::vector<Vector3f> equilibrium_under(const Case& patient_case, const TickResult& result) {
    const DeformableBody& body = patient_case.deformable_bodies[0];
    const ContactBodies bodies(patient_case, true);
    hyperelasticity::Equilibrium equilibrium(body);
    const auto place = [&](std::size_t vertex) {
        const auto node = static_cast<std::size_t>(body.boundary.nodes[vertex]);
        return equilibrium.mesh().positions()[node];
    };
    std::vector<SurfaceForce> forces;
    bodies.deformable[0].append_forces(result.active_contacts(), forces);
    Eigen::VectorXd loads = Eigen::VectorXd::Zero(equilibrium.mesh().dofs());
    bodies.deformable[0].each_load(forces, [&](std::int32_t vertex, const Vector3f& force) {
        if (const auto at = place(static_cast<std::size_t>(vertex)); at >= 0)
            loads.segment<3>(3 * at) += force.cast<double>();
    });
    EXPECT_LT(equilibrium.approach(loads, 1e-9, 400), 1e-9);
    std::vector<Vector3f> moved(body.boundary.nodes.size(), Vector3f::Zero());
    for (std::size_t v = 0; v < moved.size(); ++v)
        if (const auto at = place(v); at >= 0)
            moved[v] = equilibrium.displacements().segment<3>(3 * at).cast<float>();
    return moved;
}

// The largest distance between two fields, of the largest displacement of the second.
double difference(const std::vector<Vector3f>& a, const std::vector<Vector3f>& b) {
    float largest = 0, most = 0;
    for (std::size_t v = 0; v < a.size(); ++v) {
        largest = std::max(largest, (a[v] - b[v]).norm());
        most = std::max(most, b[v].norm());
    }
    return static_cast<double>(largest / most);
}

// Of a ball of 4 mm over a cube of 20 mm: clear of it, and 4 mm deep.
const Vector3d clear_of_it(10.5, 9.5, 25), pressed_far(10.5, 9.5, 20);

TEST(LargeDeformation, at_rest_the_surface_is_that_of_the_equilibrium_under_what_is_felt) {
    for (const double friction : {0.0, 0.5}) {
        const Case cube = far_cube(8, friction);
        Felt felt(cube);
        felt.go(clear_of_it, pressed_far);
        felt.go(pressed_far, pressed_far + Vector3d(1, 0.5, 0));
        const TickResult result = felt.rest(pressed_far + Vector3d(1, 0.5, 0), 300);
        ASSERT_GT(force_of(result).norm(), 0.1);
        EXPECT_EQ(result.status, tick_ok);
        const auto truth = equilibrium_under(cube, result);
        EXPECT_LT(difference(felt.drawn(), truth), search_error) << friction;
        // The compliance alone is farther off by much.
        std::vector<Vector3f> linear(truth.size());
        felt.model.surface_displacement(0, result, linear);
        EXPECT_GT(difference(linear, truth), linear_error) << friction;
    }
}

TEST(LargeDeformation, is_not_felt_in_a_slight_touch) {
    const Case cube = far_cube(8);
    Case linear = cube;
    linear.hyperelastic.clear();
    Felt far(cube), near(linear);
    const Vector3d slight(10.5, 9.5, 23.8);  // 0.2 mm deep
    for (Felt* felt : {&far, &near}) felt->go(clear_of_it, slight);
    const double here = force_of(far.rest(slight, 200)).norm(),
                 there = force_of(near.rest(slight, 200)).norm();
    ASSERT_GT(there, 1e-3);
    EXPECT_NEAR(here, there, second_order * there);
}

TEST(LargeDeformation, stiffens_tissue_that_is_pressed_far) {
    const Case cube = far_cube(8);
    Case linear = cube;
    linear.hyperelastic.clear();
    Felt far(cube), near(linear);
    for (Felt* felt : {&far, &near}) felt->go(clear_of_it, pressed_far);
    EXPECT_GT(force_of(far.rest(pressed_far, 300)).norm(),
              (1 + linear_error) * force_of(near.rest(pressed_far, 300)).norm());
}

TEST(LargeDeformation, comes_to_the_same_force_by_every_way) {
    const Case cube = far_cube(8);
    Felt straight(cube), about(cube);
    straight.go(clear_of_it, pressed_far);
    about.go(clear_of_it, pressed_far + Vector3d(2, 1, -1));
    about.go(pressed_far + Vector3d(2, 1, -1), pressed_far);
    const Vector3d one = force_of(straight.rest(pressed_far, 500)),
                   other = force_of(about.rest(pressed_far, 500));
    EXPECT_LT((one - other).norm(), search_error * one.norm());
}

TEST(LargeDeformation, gives_back_what_a_loop_took_and_steps_nowhere) {
    Felt felt(far_cube(8));
    felt.go(clear_of_it, pressed_far);
    felt.rest(pressed_far, 100);
    const double stored = -felt.work;
    ASSERT_GT(stored, 0.1);
    constexpr double radius = 2;  // mm, at 10 mm/s
    const int count = static_cast<int>(2 * std::numbers::pi * radius / 0.01);
    for (const double way : {1.0, -1.0}) {
        const double before = felt.work;
        Vector3d last = force_of(felt.result);
        for (int tick = 1; tick <= count; ++tick) {
            const double angle = way * 2 * std::numbers::pi * tick / count;
            const Vector3d force =
                force_of(felt.at(pressed_far + radius * Vector3d(std::cos(angle) - 1, std::sin(angle), 0)));
            EXPECT_LT((force - last).norm(), most_step * force.norm());
            EXPECT_EQ(felt.result.status, tick_ok);
            last = force;
        }
        EXPECT_LT(std::abs(felt.work - before), most_work * stored) << way;
    }
}

TEST(LargeDeformation, says_that_answers_stay_away_and_no_longer_once_they_come) {
    Felt felt(far_cube(8));
    felt.go(clear_of_it, pressed_far);
    EXPECT_EQ(felt.rest(pressed_far, 200).status, tick_ok);
    felt.answers = false;
    constexpr int still_fresh = 80, stale = 120;  // ticks: a tenth of a second is late
    EXPECT_EQ(felt.rest(pressed_far, still_fresh).status, tick_ok);
    EXPECT_EQ(felt.rest(pressed_far, stale - still_fresh).status, large_unsettled);
    felt.answers = true;
    EXPECT_EQ(felt.rest(pressed_far, 2 * ticks_per_answer).status, tick_ok);
    // Of a tool that touches nothing nothing is late.
    felt.answers = false;
    EXPECT_EQ(felt.rest(clear_of_it, stale).status, tick_ok);
    EXPECT_EQ(felt.rest(pressed_far, 1).status & large_unsettled, 0U);
}

// Pushed in at once by a fifth of the cube's height, tissue needs more steps than one answer has.
TEST(LargeDeformation, says_where_its_search_has_not_settled) {
    Felt felt(far_cube(8));
    felt.rest(clear_of_it, 20);
    int told = 0;
    for (int tick = 0; tick < 5 * ticks_per_answer; ++tick)
        told += (felt.at(pressed_far).status & large_unsettled) != 0;
    EXPECT_GT(told, 0);
    EXPECT_EQ(felt.rest(pressed_far, 300).status, tick_ok);
}

TEST(LargeDeformation, forgets_all_once_nothing_is_touched) {
    Felt felt(far_cube(8)), fresh(far_cube(8));
    felt.go(clear_of_it, pressed_far);
    felt.go(pressed_far, clear_of_it);
    felt.rest(clear_of_it, 50);
    fresh.rest(clear_of_it, 50);  // a body is felt once the tool has been clear of it
    felt.ticks = fresh.ticks = 0;
    for (const double depth : {0.5, 2.0, 5.0}) {
        const Vector3d to(9, 11, 24 - depth);
        EXPECT_EQ(force_of(felt.rest(to, 3)), force_of(fresh.rest(to, 3))) << depth;
    }
    for (const Vector3f& moved : (felt.rest(clear_of_it, 50), felt.drawn()))
        EXPECT_EQ(moved, Vector3f::Zero());
}

TEST(LargeDeformation, holds_the_force_where_tissue_is_pressed_by_two_fifths_of_its_height) {
    Felt felt(far_cube(6));
    const Vector3d through(10.5, 9.5, 16);  // 8 mm deep
    felt.go(clear_of_it, through);
    double least = 1e9, most = 0;
    felt.rest(through, 500);
    for (int tick = 0; tick < 500; ++tick) {
        const double force = force_of(felt.at(through)).norm();
        least = std::min(least, force);
        most = std::max(most, force);
    }
    EXPECT_GT(least, 0.2);
    EXPECT_LT(most - least, most_step * most);
}

TEST(LargeDeformation, allocates_in_neither_tick_nor_loop) {
    Felt felt(far_cube(6, 0.3));
    felt.go(clear_of_it, pressed_far);
    std::size_t allocated = 0;
    {
        const AllocationTrap trap;
        felt.go(pressed_far, pressed_far + Vector3d(2, 0, -1));
        felt.go(pressed_far, clear_of_it);
        allocated = trap.count();
    }
    EXPECT_EQ(allocated, 0U);
}

TEST(LargeDeformation, of_a_body_that_is_not_there_is_refused_with_those_that_are) {
    Case cube = far_cube(4);
    cube.hyperelastic = {"spleen"};
    try {
        const HapticModel model(cube);
        FAIL();
    } catch (const InvalidInput& error) {
        EXPECT_NE(std::string(error.what()).find("no deformable body 'spleen'"), std::string::npos);
        EXPECT_NE(std::string(error.what()).find(cube.deformable_bodies[0].name), std::string::npos);
    }
}

}  // namespace
}  // namespace palpate
