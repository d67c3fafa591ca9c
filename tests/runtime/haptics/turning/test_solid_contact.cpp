// SPDX-License-Identifier: Apache-2.0
// A whole tool that turns, its triangles against those of rigid bodies.
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>
#include <random>

#include "formats/model/arrays.hpp"
#include "formats/model/errors.hpp"
#include "runtime/collision/features/split_edges.hpp"
#include "runtime/collision/tree_pairs.hpp"
#include "runtime/haptics/methods/solid_contact.hpp"
#include "tests/runtime/collision/collision_scene.hpp"
#include "tests/runtime/haptics/held_tool.hpp"
#include "tests/runtime/haptics/turning/turned_tool.hpp"
#include "tests/runtime/samples.hpp"

namespace palpate {
namespace {

using namespace haptics;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double torsional = 450;  // N mm/rad

double longest_edge(const collision::TriangleCorners& t) {
    return std::max({(t[1] - t[0]).norm(), (t[2] - t[1]).norm(), (t[0] - t[2]).norm()});
}

// Two surfaces, one of them a tool's, and a watch over them.
struct Watched {
    TriangleMesh body, tool;
    collision::CollisionSurface surface;
    collision::SurfaceFeatures features, tool_features;
    std::vector<SolidBody> bodies{{&surface, &features}};
    SolidWatch watch{tool_features, bodies};

    Watched(const TriangleMesh& of_body, const TriangleMesh& of_tool)
        : body(of_body),
          tool(of_tool),
          surface(body, sample::median_tree(body, 4), "body"),
          features(body.vertices, slots()),
          tool_features(tool.vertices, tool.triangles) {}

    std::vector<Triangle> slots() const {
        std::vector<Triangle> in_order;
        for (std::int32_t slot = 0; slot < surface.triangle_count(); ++slot)
            in_order.push_back(body.triangles[static_cast<std::size_t>(surface.mesh_triangle(slot))]);
        return in_order;
    }

    // By all triangles against all, but for those that balls show to be apart by more than close.
    double distance(const ToolPose& pose) const {
        const Eigen::Matrix3d R = pose.orientation.toRotationMatrix();
        double least = std::numeric_limits<double>::infinity();
        for (std::size_t t = 0; t < tool_features.triangle_count(); ++t) {
            collision::TriangleCorners corners = tool_features.corners(t);
            for (Vector3d& corner : corners) corner = pose.position + R * corner;
            for (std::int32_t slot = 0; slot < surface.triangle_count(); ++slot) {
                const collision::TriangleCorners other = surface.corners(slot);
                if ((corners[0] - other[0]).norm() >
                    longest_edge(corners) + longest_edge(other) + SolidWatch::close)
                    continue;
                least = std::min(
                    least, collision::closest_points_of_triangles(corners, other).on_a.squared_distance);
            }
        }
        return std::sqrt(least);
    }
    double least_of_touches() {
        double least = std::numeric_limits<double>::infinity();
        for (const ToolTouch& touch : watch.touches()) least = std::min(least, touch.distance);
        return least + SolidWatch::margin;
    }
};

TEST(Solid, its_least_distance_is_that_of_all_triangles_against_all) {
    constexpr double tolerance = 1e-9;  // mm
    Watched it(spiky_ball(1), spiky_ball(2));
    std::mt19937 random(5);
    ToolPose pose{{60, 0, 0}, Quaterniond::Identity()};  // clear of each other
    int close = 0;
    for (int k = 0; k < samples_of(4000); ++k) {
        // Between the two, so that what it passes on its way is looked at too.
        bring_to_rest(it.watch, {any_pose(6, random), coupling, torsional}, pose);
        if (k % 4 > 0) continue;
        const double exact = it.distance(pose);
        ASSERT_GT(exact, 0) << k;
        if (exact >= SolidWatch::close) continue;
        ++close;
        ASSERT_NEAR(it.least_of_touches(), exact, tolerance) << k;
    }
    EXPECT_GT(close, samples_of(400));
}

TEST(Solid, a_face_on_a_plate_is_pushed_back_along_its_normal_without_torque) {
    HapticModel model(plate_and_bar(), "solid");
    const TickResult result = rest_at(model, turned_at({0, 0, -2}, Quaterniond::Identity()));
    EXPECT_EQ(result.status, tick_ok);
    EXPECT_EQ(result.body, 0);
    EXPECT_NEAR(result.depth, 2, 1e-6);
    EXPECT_EQ(result.residual, 0);  // it stays outside
    EXPECT_NEAR(tool_of(result).z(), SolidWatch::margin, 1e-3);
    EXPECT_NEAR(force_of(result).z(), coupling * (2 + SolidWatch::margin), 1e-3);
    EXPECT_LT(force_of(result).head<2>().norm(), 1e-6);
    EXPECT_LT(torque_of(result).norm(), 1e-3);
}

TEST(Solid, a_bar_over_a_rim_turns_and_gives_the_torque_of_its_lever) {
    // It lies along x over the plate's rim at x = 20, held 3 mm lower.
    HapticModel model(plate_and_bar(), "solid");
    const Quaterniond lying = about(Vector3d::UnitY(), -90);  // shaft along -x
    const TickResult result = rest_at(model, turned_at({50, 0, -2}, lying), 5);
    EXPECT_GT(force_of(result).z(), 0.1);
    const Vector3d arm = Vector3d(20, 0, 0) - tool_of(result);
    const double tolerance = 1e-3 * torque_of(result).norm();  // the margin over the lever
    EXPECT_NEAR(torque_of(result).y(), arm.cross(force_of(result)).y(), tolerance);
    EXPECT_LT(std::abs(torque_of(result).x()), tolerance);
}

TEST(Solid, contacts_give_the_force_and_the_torque) {
    HapticModel model(plate_and_bar(), "solid");
    const TickResult result = rest_at(model, turned_at({5, 3, -1}, about({0.6, 0.8, 0}, 25)));
    Vector3d force = Vector3d::Zero();
    for (const Contact& contact : result.active_contacts()) force += reaction_of(contact);
    EXPECT_GT(force.norm(), 0.1);
    EXPECT_LT((force - force_of(result)).norm(), 1e-3);
    for (const Contact& contact : result.active_contacts()) EXPECT_GE(contact.triangle, 0);
}

TEST(Solid, a_tool_in_a_corner_is_held_by_both_walls) {
    Case c = plate_and_bar();
    c.rigid_bodies.push_back(rigid("wall", box({-20, -20, 0.5}, {-10, 20, 30})));
    HapticModel model(c, "solid");
    TickResult result = rest_at(model, turned_at({-8, 0, -1}, Quaterniond::Identity()));
    for (int tick = 0; tick <= 300; ++tick)
        model.tick(turned_at({-8 - 0.01 * tick, 0, -1}, Quaterniond::Identity()), result);
    EXPECT_NEAR(force_of(result).x(), coupling * (2 + SolidWatch::margin), 1e-3);
    EXPECT_NEAR(force_of(result).z(), coupling * (1 + SolidWatch::margin), 1e-3);
    EXPECT_EQ(result.residual, 0);
}

TEST(Solid, a_closed_loop_of_position_and_orientation_gives_no_energy) {
    HapticModel model(plate_and_bar(), "solid");
    const Loop loop = work_of_loop(model, torsional);
    EXPECT_GT(loop.stored, 0.3);
    EXPECT_LT(std::abs(loop.work), 0.01 * loop.stored);
}

TEST(Solid, a_tool_that_begins_inside_feels_nothing_until_it_has_been_clear) {
    feels_nothing_from_inside("solid");
    HapticModel model(plate_and_bar(), "solid");
    TickResult result{};
    model.tick(turned_at({0, 0, -1}, Quaterniond::Identity()), result);
    EXPECT_TRUE(result.status & starts_inside);
    model.tick(turned_at({0, 0, 1}, Quaterniond::Identity()), result);
    EXPECT_EQ(result.status, tick_ok);
    EXPECT_GT(force_of(rest_at(model, turned_at({0, 0, -1}, Quaterniond::Identity()), 2)).z(), 0.1);
}

TEST(Solid, no_tool_passes_through_a_thin_sheet_at_any_speed) {
    throw_on_sheet("solid", [](const HapticModel&, const TickResult& result) {
        const Quaterniond tool = quaternion_of(result.tool_orientation);
        double lowest = std::numeric_limits<double>::infinity();
        for (const Vector3d& corner : bar().surface.vertices)
            lowest = std::min(lowest, (tool_of(result) + tool * corner).z());
        ASSERT_FALSE(result.status & starts_inside);
        ASSERT_GT(lowest, 0);
    });
}

TEST(Solid, without_a_body_of_its_own_the_tool_is_the_cases_ball) {
    HapticModel model(plate(), "solid");
    EXPECT_EQ(model.contact_radius(), 1);
    constexpr double facets = 0.01;  // N, of a ball of 24 corners around
    EXPECT_NEAR(force_of(rest_at(model, held_at({0, 0, 0}))).z(), coupling * (1 + SolidWatch::margin),
                facets);
}

TEST(Solid, refuses_a_case_without_rigid_bodies_and_a_tool_of_too_many_triangles) {
    EXPECT_THROW(HapticModel(soft_cube(2), "solid"), InvalidInput);
    Case c = plate_and_bar();
    c.tool->surface = collision::split_long_edges(c.tool->surface, 0.1, 1'000'000);
    ASSERT_GT(c.tool->surface.triangles.size(), SolidContact::most_triangles);
    try {
        HapticModel(c, "solid");
        FAIL() << "taken";
    } catch (const InvalidInput& error) {
        EXPECT_EQ(error.detail().culprit, "instrument");
    }
}

}  // namespace
}  // namespace palpate
