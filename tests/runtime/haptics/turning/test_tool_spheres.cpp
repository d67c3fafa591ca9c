// SPDX-License-Identifier: Apache-2.0
// The spheres that stand for an instrument.
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>

#include "formats/model/errors.hpp"
#include "runtime/collision/triangle_queries.hpp"
#include "runtime/haptics/whole_tool/rod.hpp"
#include "runtime/haptics/whole_tool/tool_spheres.hpp"
#include "tests/runtime/haptics/held_tool.hpp"

namespace palpate {
namespace {

using namespace haptics;
using Eigen::Vector3d;

constexpr std::size_t most = 96;

double distance_to(const TriangleMesh& mesh, const Vector3d& p) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const Triangle& t : mesh.triangles)
        nearest = std::min(
            nearest,
            collision::closest_point_on_triangle(p, collision::corners_of(mesh, t)).squared_distance);
    return std::sqrt(nearest);
}

bool is_inside(const TriangleMesh& mesh, const Vector3d& p) {
    const collision::CollisionSurface surface(mesh, sample::median_tree(mesh, 4), "tool");
    return !surface.is_outside(p);
}

// Half a millimetre thin.
TriangleMesh blade() {
    return box({-5, -0.25, 0}, {5, 0.25, 30});
}

TEST(ToolSpheres, lie_inside_and_touch_the_surface) {
    for (const TriangleMesh& mesh : {rod_surface(2, 40), box({-1, -1, 0}, {1, 1, 40}), blade()}) {
        const SphereFilling filling = fill_with_spheres(mesh, most);
        EXPECT_GT(filling.spheres.size(), 20U);
        EXPECT_LE(filling.spheres.size(), most);
        for (const auto& [centre, radius] : filling.spheres) {
            EXPECT_TRUE(is_inside(mesh, centre));
            EXPECT_NEAR(distance_to(mesh, centre), radius, 1e-6);
        }
    }
}

TEST(ToolSpheres, of_a_ball_are_one) {
    for (const double radius : {0.5, 3.0, 20.0}) {
        const SphereFilling filling = fill_with_spheres(rod_surface(radius, 0), most);
        ASSERT_EQ(filling.spheres.size(), 1U);
        EXPECT_NEAR(filling.spheres[0].radius, radius, 0.018 * radius);  // its faces lie up to 1.7 % inside
        EXPECT_LT(filling.spheres[0].centre.norm(), 0.02 * radius);
        EXPECT_LT(filling.largest_gap, 0.02 * radius);
    }
}

TEST(ToolSpheres, more_come_nearer_and_nearest_where_the_tip_is) {
    const TriangleMesh rod = rod_surface(2, 100);
    const double coarse = fill_with_spheres(rod, 12).largest_gap;
    const SphereFilling fine = fill_with_spheres(rod, 36);
    EXPECT_LT(fine.largest_gap, 0.5 * coarse);
    const auto apart = [&](double from, double to) {
        const auto within = std::ranges::count_if(
            fine.spheres, [&](const ToolSphere& s) { return s.centre.z() >= from && s.centre.z() < to; });
        return (to - from) / static_cast<double>(within);
    };
    EXPECT_LT(apart(0, 30), 0.8 * apart(70, 100));
    EXPECT_LT(fill_with_spheres(rod, most).largest_gap, 0.4);  // a radius apart it dips by an eighth
}

TEST(ToolSpheres, do_not_crowd) {
    const SphereFilling filling = fill_with_spheres(box({-4, -4, 0}, {4, 4, 30}), most);
    for (std::size_t i = 0; i < filling.spheres.size(); ++i)
        for (std::size_t j = 0; j < i; ++j) {
            const ToolSphere &a = filling.spheres[i], &b = filling.spheres[j];
            const double on_a_plane =
                (a.centre - b.centre).squaredNorm() - (a.radius - b.radius) * (a.radius - b.radius);
            EXPECT_GE(on_a_plane, 0.2 * std::pow(std::min(a.radius, b.radius), 2));
        }
}

TEST(ToolSpheres, of_a_thin_blade_are_as_thin) {
    for (const auto& [centre, radius] : fill_with_spheres(blade(), most).spheres) {
        EXPECT_LE(radius, 0.25 + 1e-6);
        EXPECT_LE(std::abs(centre.y()) + radius, 0.25 + 1e-6);
    }
}

TEST(ToolSpheres, are_the_same_each_time) {
    const SphereFilling a = fill_with_spheres(blade(), 40), b = fill_with_spheres(blade(), 40);
    ASSERT_EQ(a.spheres.size(), b.spheres.size());
    for (std::size_t i = 0; i < a.spheres.size(); ++i) {
        EXPECT_EQ(a.spheres[i].centre, b.spheres[i].centre);
        EXPECT_EQ(a.spheres[i].radius, b.spheres[i].radius);
    }
}

TEST(ToolSpheres, are_refused_of_what_has_no_room_inside) {
    EXPECT_THROW(fill_with_spheres(rod_surface(0.003, 0.06), most), InvalidInput);  // in metres
}

TEST(ToolSpheres, of_a_rod_are_a_radius_apart) {
    const auto spheres = rod_spheres(2, 9, 49);
    ASSERT_EQ(spheres.size(), 6U);
    EXPECT_EQ(spheres[0].centre, Vector3d(0, 0, 0));
    EXPECT_NEAR(spheres[5].centre.z(), 9, 1e-12);
    EXPECT_NEAR(spheres[1].centre.z(), 1.8, 1e-12);
    EXPECT_EQ(rod_spheres(2, 0, 49).size(), 1U);
    EXPECT_EQ(rod_spheres(1, 1000, 49).size(), 49U);
}

}  // namespace
}  // namespace palpate
