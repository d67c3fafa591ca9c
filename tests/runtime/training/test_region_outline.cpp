// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "runtime/training/region_outline.hpp"
#include "tests/formats/sample_case.hpp"

namespace palpate {
namespace {

using namespace training;
using Eigen::Vector3d;

constexpr double element = 1;  // mm: nodes of a region's tetrahedra lie so far about its own surface

// A cube [0, 20]^3 with a ball of radius 5 mm in its middle.
DeformableBody cube_with_a_ball() {
    DeformableBody body;
    body.mesh = sample::cube_mesh(20, 20);
    body.boundary = boundary_surface(body.mesh);
    return body;
}

TEST(RegionOutline, of_a_ball_below_a_plane_is_a_circle_of_its_radius_on_it) {
    const DeformableBody body = cube_with_a_ball();
    for (const Vector3d& above : {Vector3d(10, 10, 20), Vector3d(11, 9, 20), Vector3d(20, 10, 10)}) {
        const auto outline = region_outline(body, 2, above);
        ASSERT_GT(outline.size(), 25U);
        for (std::size_t i = 0; i < outline.size(); ++i) {
            const Vector3d& point = outline[i];
            const bool top = above.z() == 20;
            EXPECT_NEAR(top ? point.z() : point.x(), 20, 1e-9);
            const Vector3d middle = top ? Vector3d(10, 10, 20) : Vector3d(20, 10, 10);
            EXPECT_NEAR((point - middle).norm(), 5, element);
            EXPECT_LE((point - outline[(i + 1) % outline.size()]).norm(), 1 + 1e-9);
        }
    }
}

TEST(PlaceAbove, a_ball_is_over_its_middle_wherever_on_that_side_it_is_looked_for) {
    const DeformableBody body = cube_with_a_ball();
    for (const Vector3d& near : {Vector3d(10, 10, 20), Vector3d(13, 6, 20), Vector3d(7, 14, 20)})
        EXPECT_LT((place_above(body, 2, near) - Vector3d(10, 10, 20)).norm(), 0.2);
    EXPECT_LT((place_above(body, 2, {20, 13, 8}) - Vector3d(20, 10, 10)).norm(), 0.2);
}

TEST(PlaceAbove, a_ball_below_a_slope_is_where_the_slopes_normal_runs_through_its_middle) {
    DeformableBody body = cube_with_a_ball();
    // The upper side leans: z = 20 + (x - 10) / 2. The perpendicular on it from (10, 10, 10) meets (6, 10,
    // 18).
    for (Vector3d& vertex : body.boundary.surface.vertices)
        if (vertex.z() == 20) vertex.z() += (vertex.x() - 10) / 2;
    EXPECT_LT((place_above(body, 2, {10, 10, 20}) - Vector3d(6, 10, 18)).norm(), 0.3);
}

TEST(RegionOutline, lies_on_the_nearest_of_surfaces_that_lie_over_each_other) {
    DeformableBody body = cube_with_a_ball();
    const auto alone = region_outline(body, 2, {10, 10, 20});
    // A roof over the cube, seen from above.
    auto& surface = body.boundary.surface;
    const auto first = static_cast<std::int32_t>(surface.vertices.size());
    for (const Vector3d& corner : {Vector3d(0, 0, 40), Vector3d(20, 0, 40), Vector3d(0, 20, 40)})
        surface.vertices.push_back(corner);
    surface.triangles.push_back({first, first + 1, first + 2});
    EXPECT_EQ(region_outline(body, 2, {10, 10, 20}), alone);
}

TEST(RegionOutline, keeps_a_distance_to_its_nearest_side_the_closing_one_too) {
    const std::vector<Vector3d> square{{0, 0, 0}, {10, 0, 0}, {10, 10, 0}, {0, 10, 0}};
    EXPECT_DOUBLE_EQ(distance_to_outline(square, {5, 2, 0}), 2);
    EXPECT_DOUBLE_EQ(distance_to_outline(square, {-3, 5, 0}), 3);
    EXPECT_DOUBLE_EQ(distance_to_outline(square, {13, 14, 0}), 5);
}

}  // namespace
}  // namespace palpate
