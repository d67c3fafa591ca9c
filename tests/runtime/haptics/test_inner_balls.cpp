// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <vector>

#include "formats/model/contact/compliance_blocks.hpp"
#include "runtime/collision/rounded_triangle.hpp"
#include "runtime/haptics/contact/inner_balls.hpp"
#include "tests/runtime/haptics/held_tool.hpp"

namespace palpate {
namespace {

using namespace haptics;
using Eigen::Vector3d;

std::vector<InnerBall> balls_of(const DeformableBody& body, double tool_radius) {
    const TriangleMesh& mesh = body.boundary.surface;
    return inner_balls(mesh, {mesh, body.obb_tree, body.name}, compliance_blocks(body), tool_radius);
}

collision::RoundedTriangle rounded(const TriangleMesh& mesh, const Triangle& t,
                                   const std::vector<InnerBall>& balls) {
    collision::RoundedTriangle round;
    for (std::size_t i = 0; i < 3; ++i) {
        const auto v = static_cast<std::size_t>(t[i]);
        round.centres[i] = mesh.vertices[v] + balls[v].inset;
        round.radii[static_cast<Eigen::Index>(i)] = balls[v].radius;
    }
    return round;
}

double distance_from_rounded(const Vector3d& p, const TriangleMesh& mesh,
                             const std::vector<InnerBall>& balls) {
    double least = std::numeric_limits<double>::infinity();
    for (const Triangle& t : mesh.triangles) {
        const collision::NearestBall ball = collision::nearest_ball(p, rounded(mesh, t, balls));
        least = std::min(least, ball.distance - ball.radius);
    }
    return least;
}

TEST(InnerBalls, touch_flat_faces) {
    const DeformableBody cube = sample::elastic_cube(5);
    const std::vector<InnerBall> balls = balls_of(cube, 1);
    for (const double x : {5.0, 7.3, 9.9, 12.4})
        for (const double y : {6.1, 10.0, 13.2})
            EXPECT_NEAR(distance_from_rounded({x, y, 21.5}, cube.boundary.surface, balls), 1.5, 1e-3) << x;
}

TEST(InnerBalls, are_three_times_as_wide_as_a_small_tool_where_a_surface_is_flat) {
    const DeformableBody cube = sample::elastic_cube(5);
    const std::vector<InnerBall> balls = balls_of(cube, 0.2);
    for (std::size_t v = 0; v < balls.size(); ++v) {
        const Vector3d& p = cube.boundary.surface.vertices[v];
        if (p.z() < 20 || (p - Vector3d(10, 10, 20)).lpNorm<Eigen::Infinity>() > 7) continue;
        EXPECT_NEAR(balls[v].radius, 0.6, 1e-9);
        EXPECT_NEAR((balls[v].inset - Vector3d(0, 0, -0.6)).norm(), 0, 1e-9);
    }
}

TEST(InnerBalls, cut_off_little_of_a_sharp_edge_and_a_quarter_of_a_millimetre_at_most) {
    const auto most_cut_off = [](const DeformableBody& body) {
        const TriangleMesh& mesh = body.boundary.surface;
        const std::vector<InnerBall> balls = balls_of(body, 1);
        for (std::size_t v = 0; v < balls.size(); ++v) {
            const bool beside_held = mesh.vertices[v].z() < 4 + 1e-9;  // of the lowest layer of cells
            EXPECT_TRUE(beside_held ? balls[v].radius == 0 : balls[v].radius > 0.05) << v;
        }
        double most = 0;
        for (const Triangle& t : mesh.triangles) {
            const auto corner = [&](std::size_t i) { return mesh.vertices[static_cast<std::size_t>(t[i])]; };
            for (std::size_t i = 0; i < 3; ++i)
                for (const Vector3d& p : {corner(i), Vector3d(0.5 * (corner(i) + corner((i + 1) % 3)))})
                    most = std::max(most, std::abs(distance_from_rounded(p, mesh, balls)));
        }
        return most;
    };
    EXPECT_LT(most_cut_off(sample::elastic_cube(5)), 0.09);
    EXPECT_LT(most_cut_off(sample::true_elastic_arch(5, 12)), 0.25 + 1e-9);
}

TEST(InnerBalls, stay_inside_thin_bodies) {
    DeformableBody plate = sample::elastic_cube(5);
    for (Vector3d& v : plate.boundary.surface.vertices) v.z() *= 0.01;  // 0.2 mm thick
    plate.obb_tree = sample::median_tree(plate.boundary.surface, 4);
    double widest = 0;
    for (const InnerBall& ball : balls_of(plate, 3)) {
        EXPECT_LE(ball.radius, 0.2 / 3 + 1e-6);
        widest = std::max(widest, ball.radius);
    }
    EXPECT_GT(widest, 0.8 * 0.2 / 3);
}

TEST(InnerBalls, turn_no_triangle_of_their_centres_over) {
    DeformableBody body = sample::true_elastic_arch(5, 12);
    for (Vector3d& v : body.boundary.surface.vertices)
        v += Vector3d(0.6 * std::sin(3 * v.y()), 0, 0.6 * std::sin(5 * v.x()));
    body.obb_tree = sample::median_tree(body.boundary.surface, 4);
    const TriangleMesh& mesh = body.boundary.surface;
    const std::vector<InnerBall> balls = balls_of(body, 5);
    EXPECT_GT(std::ranges::max(balls, {}, &InnerBall::radius).radius, 1);
    for (const Triangle& t : mesh.triangles) {
        const auto vertex = [&](std::size_t i) { return mesh.vertices[static_cast<std::size_t>(t[i])]; };
        const Vector3d own = (vertex(1) - vertex(0)).cross(vertex(2) - vertex(0));
        const collision::RoundedTriangle round = rounded(mesh, t, balls);
        const Vector3d inner =
            (round.centres[1] - round.centres[0]).cross(round.centres[2] - round.centres[0]);
        EXPECT_GT(inner.dot(own), 0.1 * own.squaredNorm());
    }
}

TEST(InnerBalls, are_found_where_vertices_lie_on_each_other) {
    DeformableBody body = sample::elastic_cube(3);
    std::vector<Vector3d>& vertices = body.boundary.surface.vertices;
    vertices[1] = vertices[0];
    vertices[5] = vertices[4] + Vector3d(0, 0, 1e-15);
    body.obb_tree = sample::median_tree(body.boundary.surface, 4);
    for (const InnerBall& ball : balls_of(body, 1)) {
        EXPECT_TRUE(ball.inset.allFinite() && std::isfinite(ball.radius));
        EXPECT_GE(ball.radius, 0);
    }
}

// What they are for. The tool is 1 mm, steps are of 0.02 mm, and a step that slips over an edge turns the
// force by most of the angle by which that is bent. Returns the largest step, of the force.
double largest_step(double bend, double deep) {
    Case c;
    c.name = "arch";
    c.deformable_bodies.push_back(sample::true_elastic_arch(5, bend));
    c.haptics = {.tool_radius = 1, .coupling_stiffness = 0.5, .max_force = 50, .max_force_rate = 50};
    HapticModel model(c);
    TickResult result{};
    const auto at = [&](double angle, double depth) {
        const double from_axis = bend + 1 - depth;
        return Vector3d(10 + from_axis * std::sin(angle), 9.7, 20 - bend + from_axis * std::cos(angle));
    };
    const double begin = -0.4, end = 0.4;
    for (double depth = -1; depth < deep; depth += 0.02) model.tick(held_at(at(begin, depth)), result);
    for (int tick = 0; tick < 50; ++tick) model.tick(held_at(at(begin, deep)), result);
    Vector3d last = force_of(result);
    double largest = 0;
    for (double angle = begin; angle < end; angle += 0.02 / bend) {
        model.tick(held_at(at(angle, deep)), result);
        EXPECT_EQ(result.status, tick_ok);
        largest = std::max(largest, (force_of(result) - last).norm() / force_of(result).norm());
        last = force_of(result);
    }
    return largest;
}

TEST(SmallTool, slides_over_edges_of_a_bent_surface_without_slipping_off_them) {
    EXPECT_LT(largest_step(12, 1), 0.03);  // edges of 4 mm, bent by 19 degrees
}

TEST(SmallTool, pressed_half_again_as_deep_as_it_is_wide_slips_off_none_either) {
    EXPECT_LT(largest_step(16, 1.5), 0.03);  // 0.050 where balls are off by 0.05 mm at most
}

}  // namespace
}  // namespace palpate
