// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "formats/model/contact/compliance_blocks.hpp"
#include "formats/model/tet_mesh.hpp"
#include "tests/formats/sample_case.hpp"
#include "tests/formats/scratch.hpp"

namespace palpate {
namespace {

using Eigen::Vector3d;

// A theorem: over a closed surface the area vectors add up to nothing, and p . n dA to thrice the volume.
TEST(BoundarySurface, of_a_cube_is_closed_and_encloses_it) {
    const TetMesh mesh = sample::cube_mesh(3, 6);
    const BoundarySurface boundary = boundary_surface(mesh);
    Vector3d area = Vector3d::Zero();
    double six_times = 0, six_of_tetrahedra = 0;
    for (const Triangle& t : boundary.surface.triangles) {
        const auto corner = [&](std::size_t c) {
            return boundary.surface.vertices[static_cast<std::size_t>(t[c])];
        };
        area += (corner(1) - corner(0)).cross(corner(2) - corner(0)) / 2;
        six_times += corner(0).dot(corner(1).cross(corner(2)));
    }
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) six_of_tetrahedra += six_volume(mesh, t);
    constexpr double round_off = 1e-9;
    EXPECT_LT(area.norm(), round_off);
    EXPECT_NEAR(six_times, 6 * 216, round_off);
    EXPECT_NEAR(six_of_tetrahedra, 6 * 216, round_off);
    EXPECT_EQ(boundary.nodes.size(), 56U);  // of 4 x 4 x 4 nodes all but 2 x 2 x 2
    for (std::size_t v = 0; v < boundary.nodes.size(); ++v)
        EXPECT_EQ(boundary.surface.vertices[v],
                  mesh.rest_positions[static_cast<std::size_t>(boundary.nodes[v])]);
}

TEST(SurfaceNormals, of_a_sphere_point_away_from_its_centre) {
    const Vector3d centre(1, 2, 3);
    const TriangleMesh sphere = sample::sphere_surface(centre, 10, 3);
    const auto normals = surface_normals(sphere);
    constexpr double coarse = 0.02;  // 1 - cosine, of triangles that are a tenth of the radius
    for (std::size_t v = 0; v < normals.size(); ++v) {
        EXPECT_NEAR(normals[v].norm(), 1, 1e-12);
        EXPECT_GT(normals[v].dot((sphere.vertices[v] - centre).normalized()), 1 - coarse);
    }
}

TEST(SurfaceNormals, are_zero_where_they_cancel_each_other) {
    TriangleMesh sheet{.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, .triangles = {{0, 1, 2}, {0, 2, 1}}};
    for (const Vector3d& normal : surface_normals(sheet)) EXPECT_EQ(normal, Vector3d::Zero());
}

TEST(ComplianceBlocks, are_those_of_the_contact_nodes_and_none_where_the_surface_is_held) {
    const DeformableBody body = sample::elastic_cube(2);
    const auto blocks = compliance_blocks(body);
    ASSERT_EQ(blocks.size(), body.boundary.nodes.size());
    for (std::size_t v = 0; v < blocks.size(); ++v) {
        const bool held = body.boundary.surface.vertices[v].z() == 0;
        EXPECT_EQ(blocks[v] < 0, held) << v;
        if (!held) {
            EXPECT_EQ(body.contact_nodes[static_cast<std::size_t>(blocks[v])], body.boundary.nodes[v]);
        }
    }
}

TEST(ComplianceBlocks, of_another_body_s_compliance_are_refused_with_both_numbers) {
    DeformableBody body = sample::elastic_cube(2);
    const std::size_t nodes = body.contact_nodes.size();
    body.contact_nodes.pop_back();
    EXPECT_EQ(sample::refusal([&] { compliance_blocks(body); }),
              "wall: its compliance has " + std::to_string(nodes) + " nodes (expected " +
                  std::to_string(nodes - 1) + "); condense it again with 'palpate condense'");
}

}  // namespace
}  // namespace palpate
