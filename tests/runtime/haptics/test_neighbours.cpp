// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <gtest/gtest.h>
#include <numbers>
#include <vector>

#include "runtime/haptics/contact/body_pair.hpp"
#include "runtime/haptics/contact/equilibrium/neighbour_contact.hpp"
#include "tests/runtime/allocation_trap.hpp"
#include "tests/runtime/haptics/equilibrium_oracle.hpp"
#include "tests/runtime/haptics/held_tool.hpp"

namespace palpate {
namespace {

using namespace haptics;
using namespace realtime;
using Eigen::Vector3d;

constexpr double side = 20, apart = 0.2;  // mm: of the cubes, and from the one's side to the other's
constexpr double float_noise = 1e-5;      // relative: records and compliance are float32
// mm: what is held apart are balls of 1 mm below the vertices, which a surface that leans by a tenth leaves
// by a 200th of that, and no row is needed for an overlap of slight_gap.
constexpr double surfaces = NeighbourContact::slight_gap + 0.01;

// Of the largest displacement: what lies farther apart than two discs' radii, as the two sides of a cube do,
// takes spread loads for point loads (LoadSpread::near_compliance()).
constexpr double across = 0.05;

// Two cubes side by side along x, both held at z = 0: the first [0, 20] mm, the second from 20.2 mm on.
Case two_cubes(int cells, int other_cells, double gap = apart) {
    Case c = soft_cube(cells);
    c.name = "two cubes";
    DeformableBody other = moved(sample::true_elastic_cube(other_cells), {side + gap, 0, 0});
    other.name = "neighbour";
    c.deformable_bodies.push_back(std::move(other));
    c.haptics.tool_radius = 3;
    return c;
}

Case alone(int cells) {
    Case c = soft_cube(cells);
    c.haptics.tool_radius = 3;
    return c;
}

Case beside_a_wall(int cells) {
    Case c = alone(cells);
    c.rigid_bodies.push_back(rigid("wall", box({side + apart, -20, -5}, {side + 15, 40, 45})));
    return c;
}

// Pushes the first cube from the side, as deep as the device goes beyond it, towards the second.
DeviceState pushing(double depth, double z = 15) {
    return held_at({-3 + depth, 10, z});
}

// Every tick of a push that grows by `step` mm per tick, then holds.
std::vector<TickResult> push(HapticModel& model, double depth, double step = 0.05, int held = 40) {
    std::vector<TickResult> ticks;
    TickResult result;
    for (double d = -1; d < depth + step * (held + 0.5); d += step) {
        model.tick(pushing(std::min(d, depth)), result);
        ticks.push_back(result);
    }
    return ticks;
}

TickResult pushed(const Case& c, double depth) {
    HapticModel model(c);
    return push(model, depth).back();
}

double press_between(const TickResult& result) {
    double sum = 0;
    for (const Contact& contact : result.active_contacts())
        if (is_of_neighbour(contact)) sum += static_cast<double>(contact.force);
    return sum;
}

std::vector<Contact> of_neighbours(const TickResult& result) {
    std::vector<Contact> found;
    std::ranges::copy_if(result.active_contacts(), std::back_inserter(found), is_of_neighbour);
    return found;
}

// A surface as the oracle displaces it.
std::vector<Vector3d> displaced(const DeformableBody& body, const std::vector<Vector3d>& by) {
    std::vector<Vector3d> at = body.boundary.surface.vertices;
    for (std::size_t v = 0; v < at.size(); ++v) at[v] += by[v];
    return at;
}

// How far the vertices of one surface that rest at x = `side` are in front of the other surface, at the
// least, mm.
double room_between(const std::vector<Vector3d>& vertices, const DeformableBody& body, double side,
                    const std::vector<Vector3d>& other, const TriangleMesh& mesh) {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t v = 0; v < vertices.size(); ++v) {
        if (body.boundary.surface.vertices[v].x() != side) continue;
        double nearest = std::numeric_limits<double>::infinity(), distance = 0;
        for (const Triangle& t : mesh.triangles) {
            collision::TriangleCorners corners;
            for (std::size_t i = 0; i < 3; ++i) corners[i] = other[static_cast<std::size_t>(t[i])];
            const auto closest = collision::closest_point_on_triangle(vertices[v], corners);
            if (closest.squared_distance >= nearest) continue;
            nearest = closest.squared_distance;
            distance = collision::unit_normal(corners).dot(vertices[v] - closest.point);
        }
        least = std::min(least, distance);
    }
    return least;
}

TEST(Neighbours, hold_the_tool_together_by_what_they_are_held_by) {
    const Case c = two_cubes(5, 4);
    const TickResult result = pushed(c, 8);
    ASSERT_EQ(result.status, tick_ok);
    ASSERT_GT(press_between(result), 0.2 * force_of(result).norm());
    const EquilibriumOracle first(c.deformable_bodies[0], 0), second(c.deformable_bodies[1], 1);
    const Vector3d on_first = first.base_reaction({&result, 1}),
                   on_second = second.base_reaction({&result, 1});
    EXPECT_GT(on_second.norm(), 0.1 * on_first.norm());
    EXPECT_NEAR((on_first + on_second - force_of(result)).norm(), 0,
                100 * float_noise * force_of(result).norm());
}

TEST(Neighbours, do_not_overlap) {
    const Case c = two_cubes(5, 4);
    for (const double depth : {3.0, 6.0, 10.0}) {
        const TickResult result = pushed(c, depth);
        ASSERT_EQ(result.status, tick_ok);
        const EquilibriumOracle first(c.deformable_bodies[0], 0), second(c.deformable_bodies[1], 1);
        const auto u = first.displacements({&result, 1}), w = second.displacements({&result, 1});
        const double least =
            room_between(displaced(c.deformable_bodies[0], u), c.deformable_bodies[0], side,
                         displaced(c.deformable_bodies[1], w), c.deformable_bodies[1].boundary.surface);
        EXPECT_GT(least, -surfaces) << depth;
        if (press_between(result) > 0) {
            EXPECT_LT(least, surfaces) << depth;
        }
    }
}

TEST(Neighbours, make_the_tool_feel_more_and_less_than_a_rigid_one) {
    for (const double depth : {6.0, 10.0}) {
        const double free = force_of(pushed(alone(5), depth)).norm(),
                     soft = force_of(pushed(two_cubes(5, 4), depth)).norm(),
                     hard = force_of(pushed(beside_a_wall(5), depth)).norm();
        EXPECT_GT(soft, 1.02 * free) << depth;
        EXPECT_GT(hard, 1.02 * soft) << depth;
    }
}

TEST(Neighbours, that_are_rigid_hold) {
    const Case c = beside_a_wall(7);
    const TickResult result = pushed(c, 6);
    ASSERT_EQ(result.status, tick_ok);
    ASSERT_GT(press_between(result), 0.1 * force_of(result).norm());
    const EquilibriumOracle oracle(c.deformable_bodies[0], 1);
    const auto moved_by = oracle.displacements({&result, 1});
    double farthest = 0, most = 0;
    for (const Vector3d& u : moved_by) most = std::max(most, u.norm());
    for (const Vector3d& vertex : displaced(c.deformable_bodies[0], moved_by))
        farthest = std::max(farthest, vertex.x());
    EXPECT_NEAR(farthest, side + apart, surfaces + across * most);
    for (const Contact& contact : of_neighbours(result)) {
        const auto v = static_cast<std::size_t>(contact.other_vertex);
        const Vector3d rest = c.deformable_bodies[0].boundary.surface.vertices[v];
        // Discs about the cube's edges are cut off, which shifts their middle.
        if (std::abs(rest.y() - side / 2) < side / 2 && rest.z() < side) {
            EXPECT_NEAR(rest.x() + moved_by[v].x(), side + apart, surfaces + across * most);
        }
    }
}

TEST(Neighbours, push_back_along_normals_with_forces_that_the_record_tells) {
    const Case c = two_cubes(5, 4);
    const TickResult result = pushed(c, 8);
    Vector3d on_tool = Vector3d::Zero();
    for (const Contact& contact : result.active_contacts()) on_tool += force_on_tool(contact);
    EXPECT_NEAR((on_tool - force_of(result)).norm(), 0, 10 * float_noise * force_of(result).norm());
    for (const Contact& contact : of_neighbours(result)) {
        EXPECT_EQ(contact.part, -1);
        EXPECT_EQ(contact.body + contact.other_body, 1);
        EXPECT_GE(contact.other_vertex, 0);
        EXPECT_GT(contact.force, 0);
        // From the triangle's body to the vertex's.
        EXPECT_LT((contact.other_body == 0 ? 1 : -1) * normal_of(contact).x(), -0.5);
        EXPECT_EQ(contact.friction, (std::array<float, 3>{0, 0, 0}));
    }
}

TEST(Neighbours, are_shown_where_they_are_pushed_to) {
    const Case c = two_cubes(5, 4);
    HapticModel model(c);
    const TickResult result = push(model, 8).back();
    const EquilibriumOracle oracle(c.deformable_bodies[1], 1);
    std::vector<Eigen::Vector3f> shown(c.deformable_bodies[1].boundary.nodes.size());
    model.surface_displacement(1, result, shown);
    double most = 0;
    for (std::size_t v = 0; v < shown.size(); ++v) {
        Vector3d mean = Vector3d::Zero();
        for (const LoadSpread::Share& share : oracle.spread().shares(static_cast<std::int32_t>(v)))
            mean += static_cast<double>(share.weight) *
                    shown[static_cast<std::size_t>(share.vertex)].cast<double>();
        const Vector3d wanted = oracle.displacements({&result, 1})[v];
        most = std::max(most, wanted.norm());
        EXPECT_NEAR((mean - wanted).norm(), 0, 1e-4);
    }
    EXPECT_GT(most, 0.3);
}

// The exact solution outside the tick, of the same push on the first cube and the same pairs of vertex and
// triangle, but without spreading the loads: so they agree on what crosses from body to body as two loads of
// the same sum do.
TEST(Neighbours, press_each_other_as_the_exact_pair_does) {
    constexpr double spreading = 0.15;
    const Case c = two_cubes(5, 5);
    const TickResult result = pushed(c, 8);
    ASSERT_EQ(result.status, tick_ok);
    TickResult tool = result;
    tool.contact_count = static_cast<std::int32_t>(std::ranges::count_if(
        result.active_contacts(), [](const Contact& contact) { return !is_of_neighbour(contact); }));
    const auto by_tool = EquilibriumOracle(c.deformable_bodies[0], 0).displacements({&tool, 1});
    const BodyPair bodies{ElasticSurface(c.deformable_bodies[0]), ElasticSurface(c.deformable_bodies[1])};
    std::vector<PairContact> contacts;
    for (std::size_t v = 0; v < by_tool.size(); ++v) {
        const Vector3d vertex = bodies[0].vertices()[v];
        if (vertex.x() != side || !bodies[0].is_free(static_cast<std::int32_t>(v))) continue;
        const Vector3d now = vertex + by_tool[v];
        const auto nearest = bodies[1].collision().closest_point({side + apart, now.y(), now.z()},
                                                                 std::numeric_limits<double>::infinity());
        if (nearest->distance > 1e-6) continue;
        contacts.push_back({.node_body = 0,
                            .node = static_cast<std::int32_t>(v),
                            .polygon = bodies[1].triangles()[static_cast<std::size_t>(nearest->triangle)],
                            .weights = nearest->barycentric,
                            .normal = {-1, 0, 0},
                            .gap = now.x() - side - apart});
    }
    Vector3d exact = Vector3d::Zero();
    const PairSolution solution = solve_exactly(bodies, contacts);
    for (const VertexForce& load : solution.forces[0]) exact += load.force;
    ASSERT_GT(exact.norm(), 0.01);
    EXPECT_NEAR(press_between(result), exact.norm(), spreading * exact.norm());
}

TEST(Neighbours, give_back_what_a_closed_loop_put_in) {
    const Case c = two_cubes(5, 4);
    HapticModel model(c);
    TickResult result;
    // In, round a circle across the push, and out.
    std::vector<Vector3d> path;
    const auto line = [&](const Vector3d& to) {
        const Vector3d from = path.back();
        const int steps = static_cast<int>(std::ceil((to - from).norm() / 0.02));
        for (int k = 1; k <= steps; ++k) path.push_back(from + (to - from) * k / steps);
    };
    path.emplace_back(-4, 10, 14);
    line({5, 10, 14});
    for (int k = 1; k <= 600; ++k) {
        const double angle = 2 * std::numbers::pi * k / 600;
        path.emplace_back(5, 10 + 2 * std::sin(angle), 16 - 2 * std::cos(angle));
    }
    line({-4, 10, 14});
    double work = 0, stored = 0;
    int unsettled = 0;
    Vector3d last_force = Vector3d::Zero();
    for (std::size_t k = 0; k < path.size(); ++k) {
        model.tick(held_at(path[k]), result);
        ASSERT_EQ(result.status & ~contact_unsettled, tick_ok) << k;
        unsettled += result.status != tick_ok;
        if (k > 0) work -= 0.5 * (force_of(result) + last_force).dot(path[k] - path[k - 1]);
        stored = std::max(stored, work);
        last_force = force_of(result);
    }
    EXPECT_LE(unsettled, 2);  // one, on the circle
    EXPECT_EQ(last_force.norm(), 0);
    ASSERT_GT(stored, 0.1);
    EXPECT_NEAR(work, 0, 0.01 * stored);
}

TEST(Neighbours, out_of_reach_change_no_bit) {
    HapticModel lonely(alone(5)), far(two_cubes(5, 4, 30)), near(two_cubes(5, 4, 3));
    // The last is near, but not met by so shallow a push.
    const auto expected = push(lonely, 1.5);
    for (HapticModel* model : {&far, &near}) {
        const auto found = push(*model, 1.5);
        ASSERT_EQ(found.size(), expected.size());
        for (std::size_t k = 0; k < found.size(); ++k) {
            EXPECT_EQ(found[k].force, expected[k].force) << k;
            EXPECT_EQ(found[k].contact_count, expected[k].contact_count) << k;
        }
    }
    EXPECT_GT(force_of(expected.back()).norm(), 0.01);
}

TEST(Neighbours, are_found_by_what_could_reach_them_alone) {
    const auto candidates = [](const Case& c) {
        const ContactBodies bodies(c, true);
        return NeighbourContact(bodies).candidate_count();
    };
    EXPECT_EQ(candidates(alone(4)), 0U);
    EXPECT_EQ(candidates(two_cubes(4, 3, 30)), 0U);
    // The finer cube's vertices that face the other, but for those that are held below.
    EXPECT_GE(candidates(two_cubes(4, 3)), 20U);
    EXPECT_LE(candidates(two_cubes(4, 3)), 25U);
    EXPECT_GE(candidates(two_cubes(3, 4)), 20U);
    EXPECT_LE(candidates(two_cubes(3, 4)), 25U);
}

TEST(Neighbours, that_overlap_at_rest_press_only_what_pushes_them_farther) {
    Case c = two_cubes(5, 4, -0.7);
    HapticModel model(c);
    TickResult result;
    model.tick(pushing(-0.5), result);
    EXPECT_EQ(result.contact_count, 0);
    const auto slight = push(model, 0.3);
    EXPECT_LT(press_between(slight.back()), 0.1 * force_of(slight.back()).norm());
    model.reset();
    const auto deep = push(model, 8);
    EXPECT_EQ(deep.back().status, tick_ok);
    EXPECT_GT(press_between(deep.back()), press_between(pushed(two_cubes(5, 4), 8)) * 0.9);
}

TEST(Neighbours, part_again_without_a_trace) {
    HapticModel model(two_cubes(5, 4)), fresh(two_cubes(5, 4));
    push(model, 8);
    TickResult result;
    for (double d = 8; d > -3; d -= 0.05) model.tick(pushing(d), result);
    ASSERT_EQ(result.contact_count, 0);
    const auto again = push(model, 7), first = push(fresh, 7);
    ASSERT_EQ(again.size(), first.size());
    for (std::size_t k = 30; k < again.size(); ++k) EXPECT_EQ(again[k].force, first[k].force) << k;
}

TEST(Neighbours, move_without_jumps) {
    HapticModel model(two_cubes(5, 4));
    const auto ticks = push(model, 10);
    // N per tick: the coupling's own for 0.05 mm would be 0.025 N.
    for (std::size_t k = 1; k < ticks.size(); ++k)
        EXPECT_LT((force_of(ticks[k]) - force_of(ticks[k - 1])).norm(), 0.01) << k;
}

TEST(Neighbours, between_two_tools_are_told_of_once) {
    HapticModel model(two_cubes(5, 4), usual_contact_method, 2);
    std::vector<TickResult> results(2);
    for (double d = -1; d < 6; d += 0.05) {
        const std::array devices{pushing(d), held_at({2 * side + apart + 3 - d, 10, 15})};
        model.tick(devices, results);
    }
    EXPECT_EQ(results[0].status | results[1].status, tick_ok);
    EXPECT_GT(of_neighbours(results[0]).size(), 0U);
    EXPECT_EQ(of_neighbours(results[1]).size(), 0U);
    // Squeezed from both sides, what one cube is pressed with is what it presses with.
    EXPECT_LT(force_of(results[0]).x(), 0);
    EXPECT_GT(force_of(results[1]).x(), 0);
}

TEST(Neighbours, three_in_a_row_pass_the_push_on) {
    Case c = two_cubes(4, 4);
    c.deformable_bodies.push_back(moved(sample::true_elastic_cube(4), {2 * (side + apart), 0, 0}));
    c.deformable_bodies[2].name = "last";
    const TickResult result = pushed(c, 10);
    EXPECT_EQ(result.status, tick_ok);
    double on_last = 0;
    for (const Contact& contact : of_neighbours(result))
        if (contact.body == 2 || contact.other_body == 2) on_last += static_cast<double>(contact.force);
    EXPECT_GT(on_last, 0);
    Vector3d reactions = Vector3d::Zero();
    for (std::int32_t body = 0; body < 3; ++body)
        reactions += EquilibriumOracle(c.deformable_bodies[static_cast<std::size_t>(body)], body)
                         .base_reaction({&result, 1});
    EXPECT_NEAR((reactions - force_of(result)).norm(), 0, 100 * float_noise * force_of(result).norm());
}

TEST(Neighbours, press_with_as_many_rows_as_there_is_room_for) {
    Case c = two_cubes(8, 5);
    HapticModel model(c);
    std::size_t most = 0;
    for (const TickResult& result : push(model, 12)) {
        EXPECT_EQ(result.status & contact_unsolved, 0U);
        EXPECT_LE(result.active_contacts().size(), max_contacts);
        most = std::max(most, of_neighbours(result).size());
        EXPECT_LE(most, NeighbourContact::most_rows);
    }
    EXPECT_GT(most, 8U);
}

TEST(Neighbours, allocate_nothing_in_a_tick) {
    HapticModel model(two_cubes(5, 4)), walled(beside_a_wall(5));
    TickResult result;
    std::size_t count = 0;
    double press = 0;
    for (HapticModel* model_of : {&model, &walled}) {
        const AllocationTrap trap;
        for (double d = -1; d < 8; d += 0.05) {
            model_of->tick(pushing(d), result);
            press = std::max(press, press_between(result));
        }
        for (double d = 8; d > -3; d -= 0.1) model_of->tick(pushing(d), result);
        count += trap.count();
    }
    EXPECT_EQ(count, 0U);
    EXPECT_GT(press, 0);
}

}  // namespace
}  // namespace palpate
