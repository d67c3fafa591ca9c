// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <random>

#include "formats/model/errors.hpp"
#include "formats/model/tet_mesh.hpp"
#include "runtime/collision/points/point_shell.hpp"
#include "runtime/collision/triangle_queries.hpp"
#include "tests/formats/sample_case.hpp"

namespace palpate {
namespace {

using namespace collision;
using Eigen::Vector3d;

constexpr double float32_rounding = 1e-5;    // mm, of positions within 100 mm and of their distances
constexpr double rounded_direction = 1e-6;   // of unit normals in float32
constexpr double cosine_of_opposed = -0.5;   // as point_shell.hpp has it
constexpr double between_candidates = 0.45;  // ideal radii: what lies between the points of the surface tried

// The least radius of n discs that cover a plane of that area: by triangles (Kershner 1939).
double ideal_radius(double area, std::size_t n) {
    return std::sqrt(2 * area / (3 * std::numbers::sqrt3 * static_cast<double>(n)));
}

double area_of(const TriangleMesh& mesh) {
    double area = 0;
    for (const Triangle& triangle : mesh.triangles) {
        const TriangleCorners t = corners_of(mesh, triangle);
        area += (t[1] - t[0]).cross(t[2] - t[0]).norm() / 2;
    }
    return area;
}

TriangleMesh box(const Vector3d& edges) {
    TriangleMesh mesh = boundary_surface(sample::cube_mesh(2, 1)).surface;
    for (Vector3d& vertex : mesh.vertices) vertex = vertex.cwiseProduct(edges);
    return mesh;
}

// A spike of that height on a disc about the origin.
TriangleMesh spike(double radius, double height) {
    constexpr int sides = 40;
    TriangleMesh mesh;
    mesh.vertices = {{0, 0, 0}, {0, 0, height}};
    for (int i = 0; i < sides; ++i) {
        const double angle = 2 * std::numbers::pi * i / sides;
        mesh.vertices.emplace_back(radius * std::cos(angle), radius * std::sin(angle), 0);
        const std::int32_t here = 2 + i, next = 2 + (i + 1) % sides;
        mesh.triangles.push_back({0, next, here});
        mesh.triangles.push_back({1, here, next});
    }
    return mesh;
}

bool near_by_normal(const ShellPoint& a, const ShellPoint& b) {
    return a.normal.cast<double>().dot(b.normal.cast<double>()) > cosine_of_opposed + rounded_direction;
}

double distance(const ShellPoint& a, const ShellPoint& b) {
    return (a.position - b.position).cast<double>().norm();
}

double to_nearest(const ShellPoint& p, const std::vector<ShellPoint>& points) {
    double least = INFINITY;
    for (const ShellPoint& other : points)
        if (near_by_normal(p, other)) least = std::min(least, distance(p, other));
    return least;
}

// The farthest that a random point of the surface is from the shell.
double measured_radius(const TriangleMesh& mesh, const std::vector<ShellPoint>& points, int trials) {
    std::vector<double> areas;
    for (const Triangle& triangle : mesh.triangles) areas.push_back(area_of({mesh.vertices, {triangle}}));
    std::mt19937 generator(7);
    std::discrete_distribution<std::size_t> pick(areas.begin(), areas.end());
    std::uniform_real_distribution<double> share(0, 1);
    double farthest = 0;
    for (int i = 0; i < trials; ++i) {
        const TriangleCorners t = corners_of(mesh, mesh.triangles[pick(generator)]);
        const double root = std::sqrt(share(generator)), v = share(generator);
        const Vector3d p = (1 - root) * t[0] + root * (1 - v) * t[1] + root * v * t[2];
        farthest = std::max(farthest, to_nearest({p.cast<float>(), unit_normal(t).cast<float>()}, points));
    }
    return farthest;
}

TEST(PointShell, points_lie_on_the_surface_with_the_normal_of_their_triangle) {
    const TriangleMesh mesh = sample::sphere_surface({40, 10, 10}, 15, 2);
    for (const ShellPoint& point : point_shell(mesh, 500).points) {
        bool found = false;
        for (const Triangle& triangle : mesh.triangles) {
            const TriangleCorners t = corners_of(mesh, triangle);
            const TrianglePoint near = closest_point_on_triangle(point.position.cast<double>(), t);
            found |= near.squared_distance < float32_rounding * float32_rounding &&
                     (unit_normal(t) - point.normal.cast<double>()).norm() < rounded_direction;
        }
        ASSERT_TRUE(found) << point.position.transpose();
        ASSERT_NEAR(point.normal.norm(), 1, rounded_direction);
    }
}

TEST(PointShell, points_are_as_many_as_asked_for) {
    const TriangleMesh cube = box({10, 10, 10});
    for (const std::size_t count : {fewest_shell_points, std::size_t{37}, std::size_t{5000}}) {
        const PointShell shell = point_shell(cube, count);
        EXPECT_EQ(shell.points.size(), count);
        EXPECT_TRUE(std::isfinite(shell.covering_radius)) << count;
    }
}

TEST(PointShell, no_point_of_the_surface_is_far_from_all) {
    constexpr std::size_t count = 400;
    // 1.2 of the ideal radius, measured; a factor of two is the theorem's.
    constexpr double uneven = 1.35;
    for (const TriangleMesh& mesh :
         {sample::sphere_surface({0, 0, 0}, 10, 3), box({10, 10, 40}), spike(2, 60)}) {
        const PointShell shell = point_shell(mesh, count);
        const double ideal = ideal_radius(area_of(mesh), count);
        EXPECT_LT(shell.covering_radius, uneven * ideal);
        EXPECT_LT(measured_radius(mesh, shell.points, 20000),
                  shell.covering_radius + between_candidates * ideal);
        EXPECT_GT(measured_radius(mesh, shell.points, 20000), 0.9 * shell.covering_radius);
    }
}

// Gonzalez 1985: each is the farthest from those before it, and these distances only fall.
TEST(PointShell, first_points_are_a_coarser_shell) {
    const PointShell shell = point_shell(sample::sphere_surface({0, 0, 0}, 10, 3), 300);
    double before = INFINITY;
    for (std::size_t n = 3; n < shell.points.size(); ++n) {
        const double here = to_nearest(
            shell.points[n], {shell.points.begin(), shell.points.begin() + static_cast<std::ptrdiff_t>(n)});
        ASSERT_LE(here, before + float32_rounding) << n;
        before = here;
    }
    EXPECT_GE(before, shell.covering_radius - float32_rounding);
}

TEST(PointShell, the_same_mesh_and_count_give_the_same_points) {
    const TriangleMesh mesh = spike(2, 60);
    const PointShell a = point_shell(mesh, 1000), b = point_shell(mesh, 1000);
    EXPECT_EQ(a.covering_radius, b.covering_radius);
    EXPECT_TRUE(std::ranges::equal(a.points, b.points, [](const ShellPoint& p, const ShellPoint& q) {
        return p.position == q.position && p.normal == q.normal;
    }));
}

TEST(PointShell, a_tip_comes_first_and_points_along_its_axis) {
    const ShellPoint tip = point_shell(spike(2, 60), 100).points.front();
    EXPECT_EQ(tip.position, Eigen::Vector3f(0, 0, 60));
    EXPECT_LT((tip.normal - Eigen::Vector3f::UnitZ()).norm(), rounded_direction);
}

TEST(PointShell, corners_of_a_box_are_among_its_points) {
    const PointShell shell = point_shell(box({10, 10, 40}), 32);
    for (std::size_t i = 0; i < 8; ++i) {
        const Eigen::Vector3f scaled = shell.points[i].position.cwiseQuotient(Eigen::Vector3f(10, 10, 40));
        EXPECT_EQ(scaled, scaled.array().round().matrix()) << i;
    }
}

TEST(PointShell, sharp_vertices_are_a_quarter_at_most) {
    const PointShell shell = point_shell(sample::sphere_surface({0, 0, 0}, 10, 0), 16);
    const auto is_vertex = [](const ShellPoint& point) { return point.position.cwiseAbs().maxCoeff() == 10; };
    EXPECT_EQ(std::ranges::count_if(shell.points, is_vertex), 4) << "of an octahedron's six";
}

TEST(PointShell, both_sides_of_a_blade_are_covered) {
    constexpr std::size_t count = 400;
    const PointShell shell = point_shell(box({20, 20, 0.05}), count);
    for (const float side : {-1.0F, 1.0F}) {
        const auto faces_it = [&](const ShellPoint& point) { return point.normal.z() * side > 0.9F; };
        EXPECT_NEAR(static_cast<double>(std::ranges::count_if(shell.points, faces_it)), count / 2.0,
                    count / 20.0);
    }
}

TEST(PointShell, a_surface_without_area_and_counts_out_of_range_are_refused) {
    const TriangleMesh cube = box({10, 10, 10});
    EXPECT_THROW(point_shell(cube, fewest_shell_points - 1), InvalidInput);
    EXPECT_THROW(point_shell(cube, most_shell_points + 1), InvalidInput);
    EXPECT_THROW(point_shell({}, 10), InvalidInput);
    EXPECT_THROW(point_shell(box({10, 0, 0}), 10), InvalidInput);
}

}  // namespace
}  // namespace palpate
