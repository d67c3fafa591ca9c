// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <numbers>
#include <utility>

#include "formats/model/closure.hpp"
#include "tests/formats/sample_case.hpp"

namespace palpate {
namespace {

constexpr int inner = 5 * 13;  // a tetrahedron of the cell in the middle of 3 x 3 x 3

TEST(Closure, of_a_sphere_and_of_two_is_seen) {
    TriangleMesh surface = sample::sphere_surface({3, -2, 1}, 10, 2);
    EXPECT_TRUE(edges_cancel(surface));
    const TriangleMesh other = sample::sphere_surface({40, 0, 0}, 5, 1);
    const auto first = static_cast<std::int32_t>(surface.vertices.size());
    surface.vertices.insert(surface.vertices.end(), other.vertices.begin(), other.vertices.end());
    for (const Triangle& t : other.triangles)
        surface.triangles.push_back({first + t[0], first + t[1], first + t[2]});
    EXPECT_TRUE(edges_cancel(surface));
}

TEST(Closure, breaks_with_a_hole_a_turned_triangle_and_one_that_is_there_twice) {
    const TriangleMesh sphere = sample::sphere_surface({0, 0, 0}, 10, 2);
    TriangleMesh holed = sphere, turned = sphere, doubled = sphere;
    holed.triangles.pop_back();
    std::swap(turned.triangles[7][0], turned.triangles[7][1]);
    doubled.triangles.push_back(sphere.triangles[3]);
    for (const TriangleMesh& broken : {holed, turned, doubled}) EXPECT_FALSE(edges_cancel(broken));
}

TEST(Closure, encloses_the_volume_wherever_it_lies_and_a_negative_one_inside_out) {
    for (const Eigen::Vector3d& centre : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(9000, -9000, 9000)}) {
        TriangleMesh sphere = sample::sphere_surface(centre, 10, 5);
        const double volume = 4.0 / 3 * std::numbers::pi * 1000;
        EXPECT_NEAR(enclosed_volume(sphere), volume, 0.005 * volume);
        for (Triangle& t : sphere.triangles) std::swap(t[0], t[1]);
        EXPECT_NEAR(enclosed_volume(sphere), -volume, 0.005 * volume);
        EXPECT_TRUE(edges_cancel(sphere));
    }
}

TEST(Winding, is_one_within_a_ball_none_beyond_and_two_where_two_lie) {
    TriangleMesh surface = sample::sphere_surface({3, -2, 1}, 10, 2);
    EXPECT_NEAR(winding_number(surface, {4, -3, 2}), 1, 1e-12);
    EXPECT_NEAR(winding_number(surface, {30, 0, 0}), 0, 1e-12);
    const TriangleMesh twice{surface.vertices, surface.triangles};
    surface.triangles.insert(surface.triangles.end(), twice.triangles.begin(), twice.triangles.end());
    EXPECT_NEAR(winding_number(surface, {4, -3, 2}), 2, 1e-12);
}

TEST(Faces, of_a_mesh_cancel_but_for_its_boundary) {
    const TetMesh mesh = sample::cube_mesh(3, 30);
    EXPECT_TRUE(faces_cancel(mesh, boundary_surface(mesh)));
}

TEST(Faces, of_a_tetrahedron_that_is_there_again_do_not) {
    for (int times = 1; times <= 3; ++times) {
        TetMesh mesh = sample::cube_mesh(3, 30);
        for (int i = 0; i < times; ++i) mesh.tetrahedra.push_back(mesh.tetrahedra[inner]);
        EXPECT_FALSE(faces_cancel(mesh, boundary_surface(mesh))) << times;
    }
}

}  // namespace
}  // namespace palpate
