// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <random>

#include "runtime/collision/rounded_triangle.hpp"
#include "tests/runtime/collision/collision_scene.hpp"

namespace palpate {
namespace {

using namespace collision;
using Eigen::Vector3d;

class RandomRoundedTriangles {
  public:
    Vector3d point(double reach) { return in_cube(reach, generator_); }
    // Radii that differ by less than the corners are apart, but for every tenth triangle.
    RoundedTriangle triangle(int index) {
        RoundedTriangle t{.centres = {point(2), point(2), point(2)}, .radii = {}};
        const double most = index % 10 == 0 ? 3 : 0.4;
        std::uniform_real_distribution<double> radius(0, most);
        t.radii = {radius(generator_), radius(generator_), radius(generator_)};
        return t;
    }

  private:
    std::mt19937 generator_{11};
};

double gap(const Vector3d& p, const RoundedTriangle& t) {
    const NearestBall ball = nearest_ball(p, t);
    return ball.distance - ball.radius;
}

// Of the balls at 100 by 100 points of the triangle.
double least_of_many(const Vector3d& p, const RoundedTriangle& t) {
    constexpr int steps = 100;
    double least = std::numeric_limits<double>::infinity();
    for (int i = 0; i <= steps; ++i)
        for (int j = 0; i + j <= steps; ++j) {
            const Vector3d w = Vector3d(steps - i - j, i, j) / steps;
            const Vector3d centre = w[0] * t.centres[0] + w[1] * t.centres[1] + w[2] * t.centres[2];
            least = std::min(least, (p - centre).norm() - w.dot(t.radii));
        }
    return least;
}

TEST(NearestBall, is_nearer_than_any_other_between_the_corners) {
    RandomRoundedTriangles random;
    for (int i = 0; i < 1000; ++i) {
        const RoundedTriangle t = random.triangle(i);
        const Vector3d p = random.point(4);
        const double found = gap(p, t), least = least_of_many(p, t);
        ASSERT_LE(found, least + 1e-9) << i;
        ASSERT_GE(found, least - 5e-3) << i;  // mm: the points are up to 0.05 mm apart, and the least is flat
    }
}

TEST(NearestBall, lies_where_its_weights_say) {
    RandomRoundedTriangles random;
    for (int i = 0; i < 1000; ++i) {
        const RoundedTriangle t = random.triangle(i);
        const Vector3d p = random.point(4);
        const NearestBall ball = nearest_ball(p, t);
        ASSERT_GE(ball.barycentric.minCoeff(), 0) << i;
        ASSERT_NEAR(ball.barycentric.sum(), 1, 1e-12) << i;
        const Vector3d centre = ball.barycentric[0] * t.centres[0] + ball.barycentric[1] * t.centres[1] +
                                ball.barycentric[2] * t.centres[2];
        ASSERT_NEAR((ball.centre - centre).norm(), 0, 1e-12) << i;
        ASSERT_NEAR(ball.distance, (p - centre).norm(), 1e-12) << i;
        ASSERT_NEAR(ball.radius, ball.barycentric.dot(t.radii), 1e-12) << i;
        const int on = static_cast<int>((ball.barycentric.array() > 0).count());
        ASSERT_EQ(ball.feature, on == 3 ? Feature::face : on == 2 ? Feature::edge : Feature::vertex) << i;
    }
}

TEST(NearestBall, of_balls_alike_is_the_nearest_point_of_the_triangle) {
    RandomRoundedTriangles random;
    for (int i = 0; i < 1000; ++i) {
        RoundedTriangle t = random.triangle(i);
        t.radii.setConstant(0.3);
        const Vector3d p = random.point(4);
        const TrianglePoint point = closest_point_on_triangle(p, t.centres);
        ASSERT_NEAR((nearest_ball(p, t).centre - point.point).norm(), 0, 1e-9) << i;
    }
}

// The gradient of the gap, on which contact's forces stand.
TEST(NearestBall, changes_its_distance_along_the_normal_and_by_its_weights) {
    RandomRoundedTriangles random;
    constexpr double step = 1e-6;
    for (int i = 0; i < 1000; ++i) {
        const RoundedTriangle t = random.triangle(i);
        const Vector3d p = random.point(4);
        const NearestBall ball = nearest_ball(p, t);
        if (ball.distance < 0.1) continue;
        const Vector3d normal = (p - ball.centre) / ball.distance;
        for (Eigen::Index axis = 0; axis < 3; ++axis) {
            const Vector3d by = step * Vector3d::Unit(axis);
            ASSERT_NEAR((gap(p + by, t) - gap(p - by, t)) / (2 * step), normal[axis], 1e-5) << i;
            for (std::size_t corner = 0; corner < 3; ++corner) {
                RoundedTriangle ahead = t, behind = t;
                ahead.centres[corner] += by;
                behind.centres[corner] -= by;
                ASSERT_NEAR((gap(p, ahead) - gap(p, behind)) / (2 * step),
                            -ball.barycentric[static_cast<Eigen::Index>(corner)] * normal[axis], 1e-5)
                    << i;
            }
        }
    }
}

TEST(NearestBall, of_a_triangle_without_area_lies_on_its_edges) {
    const RoundedTriangle t{.centres = {Vector3d(0, 0, 0), Vector3d(1, 0, 0), Vector3d(2, 0, 0)},
                            .radii = {0.1, 0.2, 0.1}};
    const NearestBall ball = nearest_ball({1, 3, 0}, t);
    EXPECT_NEAR((ball.centre - Vector3d(1, 0, 0)).norm(), 0, 1e-12);
    EXPECT_NEAR(ball.distance - ball.radius, 2.8, 1e-12);
}

}  // namespace
}  // namespace palpate
