// SPDX-License-Identifier: Apache-2.0
// A whole tool that turns, pushed off where it is near rigid bodies: by local minima of its distance from
// them, and by the closest features of convex pieces.
#include <algorithm>
#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>
#include <memory>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "formats/model/arrays.hpp"
#include "formats/model/errors.hpp"
#include "runtime/collision/balls/ball_pairs.hpp"
#include "runtime/collision/features/split_edges.hpp"
#include "runtime/collision/tree_pairs.hpp"
#include "runtime/haptics/cones/cone_watch.hpp"
#include "runtime/haptics/features/feature_watch.hpp"
#include "runtime/haptics/methods/gap_contact.hpp"
#include "tests/runtime/allocation_trap.hpp"
#include "tests/runtime/haptics/held_tool.hpp"
#include "tests/runtime/haptics/turning/turned_tool.hpp"

namespace palpate {
namespace {

using namespace haptics;
using Eigen::Quaterniond;
using Eigen::Vector3d;

// Both ways have it, by the name of the scheme.
class NearPlaces : public testing::TestWithParam<std::string> {};

// Of plate_and_bar(): 99 N at most on 100 N/mm.
constexpr double reach = 0.99;  // mm

double lowest_of_bar(const TickResult& result) {
    double lowest = std::numeric_limits<double>::infinity();
    for (const Vector3d& corner : bar().surface.vertices)
        lowest = std::min(lowest, (tool_of(result) + quaternion_of(result.tool_orientation) * corner).z());
    return lowest;
}

TEST_P(NearPlaces, a_face_over_a_plate_is_pushed_back_along_its_normal_before_it_meets_it) {
    HapticModel model(plate_and_bar(), GetParam());
    const TickResult result = rest_at(model, turned_at({0, 0, -2}, Quaterniond::Identity()));
    EXPECT_EQ(result.status, tick_ok);
    EXPECT_EQ(result.body, 0);
    const double gap = tool_of(result).z();
    EXPECT_GT(gap, 0);
    EXPECT_LT(gap, reach);
    EXPECT_NEAR(force_of(result).z(), coupling * (2 + gap), 1e-6);
    EXPECT_LT(force_of(result).head<2>().norm(), 1e-3);
    EXPECT_LT(torque_of(result).norm(), 0.1);
    EXPECT_EQ(result.residual, 0);
}

// A tool over a body as one of the ways watches them.
class Watchers {
  public:
    Watchers(const std::string& scheme, const TriangleMesh& tool, const TriangleMesh& body, double within)
        : scheme_(scheme),
          within_(within),
          tool_(tool.vertices, tool.triangles),
          body_(body.vertices, body.triangles),
          tool_tree_(tool_),
          body_tree_{collision::NormalConeTree(body_)},
          tool_pieces_(tool_),
          body_pieces_{collision::ConvexPieces(body_)} {}
    std::unique_ptr<GapWatch> watch() const {
        if (scheme_ == "cones") return std::make_unique<ConeWatch>(tool_tree_, body_tree_, within_);
        return std::make_unique<FeatureWatch>(tool_pieces_, body_pieces_, within_);
    }

  private:
    std::string scheme_;
    double within_;
    collision::SurfaceFeatures tool_, body_;
    collision::NormalConeTree tool_tree_;
    std::vector<collision::NormalConeTree> body_tree_;
    collision::ConvexPieces tool_pieces_;
    std::vector<collision::ConvexPieces> body_pieces_;
};

TEST_P(NearPlaces, forces_and_moments_are_those_of_springs_there) {
    const Case c = plate_and_bar();
    const Watchers watched(GetParam(), c.tool->surface, c.rigid_bodies[0].surface, reach);
    HapticModel model(c, GetParam());
    const ToolPose device{{5, 3, -1}, about(Vector3d(1, 2, 0.5).normalized(), 25)};
    const TickResult result = rest_at(model, turned_at(device.position, device.orientation), 8);
    const auto watch = watched.watch();
    watch->look({tool_of(result), quaternion_of(result.tool_orientation)});
    ASSERT_FALSE(watch->close().empty());
    Vector3d force = Vector3d::Zero(), moment = Vector3d::Zero();
    for (const ToolTouch& touch : watch->close()) {
        const Vector3d f = -100 * touch.distance * touch.gradient();
        EXPECT_NEAR(touch.gradient().norm(), 1, 1e-12);
        force += f;
        moment += touch.arm.cross(f);
    }
    EXPECT_NEAR((force - force_of(result)).norm(), 0, 2e-3);
    EXPECT_NEAR((moment - torque_of(result)).norm(), 0, 2e-2);
    EXPECT_GT(torque_of(result).norm(), 1);
}

TEST_P(NearPlaces, that_are_followed_while_the_tool_moves_a_little_are_all_there_are) {
    const Watchers watched(GetParam(), collision::split_long_edges(bar().surface, 2, 5000),
                           sample::sphere_surface({0, 0, 0}, 15, 3), 2);
    const auto kept = watched.watch();
    std::mt19937 random(3);
    std::normal_distribution<double> step(0, 1);
    ToolPose pose{{16, 0, 0}, about(Vector3d(1, 2, 0.5).normalized(), 60)};
    std::size_t found = 0;
    for (int k = 0; k < samples_of(3000); ++k) {
        Twist motion;
        for (double& x : motion) x = step(random);
        motion.head<3>() *= 0.05;
        motion.tail<3>() *= 0.003;
        motion.head<3>() -= 0.02 * (pose.position.norm() - 16) * pose.position.normalized();
        pose = moved(pose, motion);
        kept->look(pose);
        const auto anew = watched.watch();
        anew->look(pose);
        const auto distances = [](const GapWatch& watch) {
            std::vector<double> all;
            for (const ToolTouch& touch : watch.close()) all.push_back(touch.distance);
            std::ranges::sort(all);
            return all;
        };
        ASSERT_THAT(distances(*kept), testing::Pointwise(testing::DoubleNear(1e-9), distances(*anew))) << k;
        found += kept->close().size();
    }
    EXPECT_GT(found, static_cast<std::size_t>(samples_of(1000)));
}

// Bumps and hollows, little steps, leaps, and now and then a tool that is found anew.
TEST_P(NearPlaces, the_narrowest_is_as_wide_as_the_surfaces_are_apart) {
    TriangleMesh tool = sample::sphere_surface({0, 0, 0}, 4, 2),
                 body = sample::sphere_surface({0, 0, 0}, 10, 2);
    for (TriangleMesh* mesh : {&tool, &body})
        for (Vector3d& v : mesh->vertices)
            v *= 1 + 0.2 * std::sin(0.9 * v.x()) * std::cos(1.1 * v.y()) * std::sin(0.7 * v.z() + 1);
    const collision::SurfaceFeatures of_tool(tool.vertices, tool.triangles),
        of_body(body.vertices, body.triangles);
    const auto apart = [&](const ToolPose& pose) {
        double least = std::numeric_limits<double>::infinity();
        for (std::size_t a = 0; a < of_tool.triangle_count(); ++a) {
            const auto corners = collision::placed(placement_of(pose), of_tool.corners(a));
            for (std::size_t b = 0; b < of_body.triangle_count(); ++b)
                least = std::min(least, collision::closest_points_of_triangles(corners, of_body.corners(b))
                                            .on_a.squared_distance);
        }
        return std::sqrt(least);
    };
    constexpr double within = 0.5;
    const Watchers watched(GetParam(), tool, body, within);
    const auto watch = watched.watch();
    std::mt19937 random(4);
    std::normal_distribution<double> step(0, 1);
    ToolPose pose{{15, 0, 0}, Quaterniond::Identity()};
    int near = 0;
    for (int k = 0; k < samples_of(600); ++k) {
        Twist motion;
        for (double& x : motion) x = step(random);
        motion *= k % 50 == 49 ? 2 : 0.04;
        pose = moved(pose, motion);
        pose.position *= 1 - 0.1 * (apart(pose) - 0.3) / pose.position.norm();
        if (k % 70 == 69) watch->reset();
        watch->look(pose);
        const double exact = apart(pose);
        if (exact == 0) {
            watch->reset();
            pose.position += 0.5 * pose.position.normalized();
            continue;
        }
        if (exact >= within) continue;
        double narrowest = std::numeric_limits<double>::infinity();
        for (const ToolTouch& touch : watch->close())
            narrowest = std::min(narrowest, touch.distance + within);
        ASSERT_NEAR(narrowest, exact, 1e-9) << k;
        ++near;
    }
    EXPECT_GT(near, samples_of(200));
}

TEST_P(NearPlaces, a_bar_that_is_held_over_a_rim_turns_and_gives_the_torque_of_its_lever) {
    HapticModel model(plate_and_bar(), GetParam());
    const Quaterniond lying = about(Vector3d::UnitY(), -90);  // shaft along -x
    const Vector3d tip(50, 0, -2);                            // beyond the plate; from x = 20 on it is above
    const TickResult result = rest_at(model, turned_at(tip, lying), 5);
    EXPECT_GT(force_of(result).z(), 0.1);
    const Vector3d rim(20, 0, 0), arm = rim - tool_of(result);
    const double tolerance = 0.03 * torque_of(result).norm();
    EXPECT_NEAR(torque_of(result).y(), arm.cross(force_of(result)).y(), tolerance);
    EXPECT_LT(std::abs(torque_of(result).x()), tolerance);
}

// Minima that come and go take their force along at once, so a closed way is not without loss here; it gives
// little.
TEST_P(NearPlaces, a_closed_loop_of_position_and_orientation_gives_hardly_any_energy) {
    HapticModel model(plate_and_bar(), GetParam());
    const Loop loop = work_of_loop(model, 450);
    RecordProperty("work_of_stored", std::to_string(loop.work / loop.stored));
    EXPECT_GT(loop.stored, 0.3);
    EXPECT_LT(loop.work, 0.05 * loop.stored);
}

TEST_P(NearPlaces, a_tool_that_begins_inside_feels_nothing_until_it_has_been_clear) {
    feels_nothing_from_inside(GetParam());
    HapticModel model(plate_and_bar(), GetParam());
    TickResult result{};
    model.tick(turned_at({0, 0, -1}, Quaterniond::Identity()), result);
    EXPECT_GT(force_of(rest_at(model, turned_at({0, 0, -1}, Quaterniond::Identity()), 4)).z(), 0.1);
}

TEST_P(NearPlaces, no_tool_passes_through_a_thin_sheet_at_any_speed) {
    throw_on_sheet(GetParam(), [](const HapticModel&, const TickResult& result) {
        ASSERT_FALSE(result.status & starts_inside);
        ASSERT_GT(lowest_of_bar(result), 0);
    });
}

TEST_P(NearPlaces, pressed_harder_than_a_minimum_bears_a_tool_stays_outside_and_comes_away_again) {
    Case c = plate_and_bar();
    c.haptics.max_force = 3;
    c.tool->settings.contact_stiffness = 10;  // 3 N from 0.3 mm on, and 5 N are asked for
    HapticModel model(c, GetParam());
    const Quaterniond on_a_corner = about(Vector3d(1, 1, 0).normalized(), 35);
    TickResult result{};
    double nearest = 1;
    for (int tick = 0; tick < 2000; ++tick) {
        const double z = 5 - 15 * std::sin(std::numbers::pi * tick / 2000.0);
        model.tick(turned_at({0, 0, z}, on_a_corner), result);
        ASSERT_GT(lowest_of_bar(result), 0) << tick;
        nearest = std::min(nearest, lowest_of_bar(result));
    }
    EXPECT_LT(nearest, 0.02);
    EXPECT_LT((tool_of(result) - Vector3d(0, 0, 5)).norm(), 0.1);
}

TEST_P(NearPlaces, without_a_body_of_its_own_the_tool_is_the_cases_ball) {
    Case c = plate();
    c.haptics.max_force = 3;  // on 10 N/mm: a reach of 0.3 mm
    HapticModel model(c, GetParam());
    EXPECT_EQ(model.contact_radius(), 1);
    const TickResult result = rest_at(model, held_at({0, 0, 0}));
    const double gap = tool_of(result).z() - 1;
    EXPECT_GT(gap, 0);
    EXPECT_LT(gap, 0.3);
    EXPECT_NEAR(force_of(result).z(), coupling * (1 + gap), 1e-6);
}

// Two tools come to a free place by different ways and are pressed alike from there: forces to the last bit.
TEST_P(NearPlaces, what_follows_a_free_tick_does_not_depend_on_how_it_was_come_to) {
    Case c = plate();
    c.haptics.max_force = 30;  // on 100 N/mm: a reach of 0.3 mm
    c.rigid_bodies[0] = rigid("ball", sample::sphere_surface({0, 0, 0}, 15, 4));
    c.tool = bar();
    c.tool->surface = sample::sphere_surface({0, 0, 0}, 3, 3);
    HapticModel one(c, GetParam()), other(c, GetParam());
    std::mt19937 random(8);
    std::normal_distribution<double> component(0, 1);
    const auto direction = [&] {
        return Vector3d(component(random), component(random), component(random)).normalized();
    };
    std::size_t pressed = 0;
    for (int place = 0; place < samples_of(80); ++place) {
        const Vector3d out = direction(), free = 18.6 * out;
        const Quaterniond turn(Eigen::AngleAxisd(0.4, direction()));
        TickResult a{}, b{};
        const auto go = [&](HapticModel& model, const Vector3d& from, TickResult& result) {
            model.reset();
            for (int tick = 0; tick <= 30; ++tick)
                model.tick(turned_at(free + (30 - tick) / 30.0 * (from - free), turn), result);
        };
        go(one, free + 2 * out.unitOrthogonal(), a);
        go(other, free + out - out.unitOrthogonal(), b);
        ASSERT_EQ(a.contact_count + b.contact_count, 0);
        for (int tick = 0; tick < 60; ++tick) {
            const auto state = turned_at(free - 0.03 * tick * out, turn);
            one.tick(state, a);
            other.tick(state, b);
            ASSERT_EQ(a.force, b.force) << place << ' ' << tick;
            ASSERT_EQ(a.torque, b.torque) << place << ' ' << tick;
            pressed += a.contact_count > 0;
        }
    }
    EXPECT_GT(pressed, static_cast<std::size_t>(samples_of(500)));
}

TEST_P(NearPlaces, ticks_without_allocation) {
    HapticModel model(plate_and_bar(), GetParam());
    TickResult result{};
    model.tick(turned_at({0, 0, 5}, Quaterniond::Identity()), result);
    const AllocationTrap trap;
    for (int tick = 0; tick < 300; ++tick)
        model.tick(turned_at({0.01 * tick, 0, 3 - 0.02 * tick}, about(Vector3d::UnitX(), 0.1 * tick)),
                   result);
    EXPECT_EQ(trap.count(), 0U);
    EXPECT_GT(force_of(result).norm(), 0.5);
}

TEST_P(NearPlaces, refuses_a_case_without_rigid_bodies_and_a_tool_of_too_many_triangles) {
    EXPECT_THROW(HapticModel(soft_cube(2), GetParam()), InvalidInput);
    Case c = plate_and_bar();
    c.tool->surface = collision::split_long_edges(c.tool->surface, 0.1, 1'000'000);
    ASSERT_GT(c.tool->surface.triangles.size(), GapContact::most_triangles);
    EXPECT_THROW(HapticModel(c, GetParam()), InvalidInput);
}

INSTANTIATE_TEST_SUITE_P(Ways, NearPlaces, testing::Values("cones", "features"),
                         [](const auto& info) { return info.param; });

}  // namespace
}  // namespace palpate
