// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <numeric>

#include "runtime/visual/cut/mark_section.hpp"

namespace palpate {
namespace {

using namespace visual;
using Eigen::Vector3d;

// A torus about the z axis: the tube's middle runs at `ring` mm from it.
TriangleMesh torus(double ring, double tube) {
    constexpr int around = 64, across = 32;
    TriangleMesh mesh;
    for (int i = 0; i < around; ++i)
        for (int j = 0; j < across; ++j) {
            const double a = 2 * std::numbers::pi * i / around, b = 2 * std::numbers::pi * j / across,
                         out = ring + tube * std::cos(b);
            mesh.vertices.emplace_back(out * std::cos(a), out * std::sin(a), tube * std::sin(b));
        }
    const auto at = [](int i, int j) { return (i % around) * across + j % across; };
    for (int i = 0; i < around; ++i)
        for (int j = 0; j < across; ++j) {
            mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
            mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
        }
    return mesh;
}

ScanPlane plane_through(const Vector3d& middle, const Vector3d& right, const Vector3d& up, double size) {
    return {
        .corner = middle - size / 2 * (right + up), .right = right, .up = up, .width = size, .height = size};
}

// From two sides and askew; against the distance from the tube's middle.
TEST(Section, is_marked_where_the_plane_runs_within_the_body) {
    constexpr double ring = 10, tube = 3, chord = 0.06;  // mm; how far faces lie off the torus
    constexpr int cells = 200;
    const TriangleMesh mesh = torus(ring, tube);
    const Eigen::Matrix3d turned = Eigen::AngleAxisd(0.7, Vector3d(1, 2, -1).normalized()).toRotationMatrix();
    for (const Eigen::Matrix3d& axes : {Eigen::Matrix3d(Eigen::Matrix3d::Identity()), turned}) {
        const ScanPlane plane = plane_through({0.5, -0.3, 0.4}, axes.col(0), axes.col(1), 40);
        const auto marks = mark_section(mesh, plane, cells, cells);
        ASSERT_EQ(marks.size(), static_cast<std::size_t>(cells * cells));
        int within = 0;
        for (int row = 0; row < cells; ++row)
            for (int column = 0; column < cells; ++column) {
                const Vector3d p = plane.corner + (column + 0.5) / cells * plane.width * plane.right +
                                   (row + 0.5) / cells * plane.height * plane.up;
                const double depth = tube - std::hypot(std::hypot(p.x(), p.y()) - ring, p.z());
                const unsigned char mark = marks[static_cast<std::size_t>(row * cells + column)];
                if (std::abs(depth) > chord) {
                    EXPECT_EQ(mark, depth > 0 ? 255 : 0) << p.transpose();
                }
                within += mark == 255 ? 1 : 0;
            }
        EXPECT_GT(within, 500);
    }
}

TEST(Section, of_a_plane_through_vertices_and_edges_leaves_no_streaks) {
    TriangleMesh cube;
    for (int i = 0; i < 8; ++i) cube.vertices.emplace_back(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
    cube.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                      {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY();
    const Vector3d askew = Vector3d(0, 1, 1).normalized();
    // In the face itself, through an edge's whole length, and rows that meet the cube's corners.
    EXPECT_EQ(std::ranges::count(mark_section(cube, plane_through({0, 0, 1}, x, y, 4), 40, 40), 255), 400);
    EXPECT_EQ(std::ranges::count(mark_section(cube, plane_through({0, 0, -1}, x, y, 4), 40, 40), 255), 0);
    EXPECT_EQ(std::ranges::count(mark_section(cube, plane_through({0, 0, 0}, x, askew, 4), 40, 40), 255),
              20 * 28);
    EXPECT_EQ(std::ranges::count(mark_section(cube, plane_through({0, 0, 0}, x, y, 4), 2, 2), 255), 1)
        << "what lies on an edge belongs to one side of it";
}

TEST(Section, of_a_plane_beside_the_body_is_empty) {
    const ScanPlane plane = plane_through({0, 0, 3.01}, Vector3d::UnitX(), Vector3d::UnitY(), 40);
    const auto marks = mark_section(torus(10, 3), plane, 20, 20);
    EXPECT_EQ(std::accumulate(marks.begin(), marks.end(), 0), 0);
}

}  // namespace
}  // namespace palpate
