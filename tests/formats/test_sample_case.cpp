// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <gtest/gtest.h>

#include "tests/formats/sample_case.hpp"

namespace palpate {
namespace {

TEST(SampleCube, tetrahedra_fill_the_cube_with_positive_volumes) {
    const TetMesh mesh = sample::cube_mesh(3, 20);
    double volume = 0;
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
        EXPECT_GT(six_volume(mesh, t), 0);
        volume += six_volume(mesh, t) / 6;
    }
    EXPECT_NEAR(volume, 8000, 1e-9);
}

TEST(SampleCube, boundary_has_twelve_triangles_per_cell_face_pair) {
    const int cells = 3;
    EXPECT_EQ(boundary_surface(sample::cube_mesh(cells, 20)).surface.triangles.size(), 12U * cells * cells);
}

TEST(SampleCube, contact_nodes_are_the_boundary_nodes_that_are_not_fixed) {
    const DeformableBody body = sample::elastic_cube(2);
    EXPECT_EQ(body.fixed_nodes.size(), 9U);
    EXPECT_EQ(body.contact_nodes.size(), body.boundary.nodes.size() - 9U);
    EXPECT_EQ(static_cast<std::size_t>(node_count(body.compliance)), body.contact_nodes.size());
}

TEST(SampleCube, kernel_compliance_is_symmetric_and_positive_definite) {
    const DeformableBody body = sample::elastic_cube(2);
    const auto& compliance = std::get<DenseCompliance>(body.compliance);
    const auto n = static_cast<Eigen::Index>(compliance.dof_count());
    const Eigen::Map<const Eigen::MatrixXf> matrix(compliance.entries.get(), n, n);
    EXPECT_EQ((matrix - matrix.transpose()).cwiseAbs().maxCoeff(), 0);
    EXPECT_EQ(matrix.cast<double>().llt().info(), Eigen::Success);
}

TEST(SampleSphere, is_closed_and_oriented_outwards) {
    const TriangleMesh sphere = sample::sphere_surface({1, 2, 3}, 10, 3);
    EXPECT_EQ(sphere.triangles.size(), 512U);
    EXPECT_EQ(sphere.vertices.size(), 258U);  // Euler: V = F / 2 + 2
    for (const Triangle& t : sphere.triangles) {
        const Eigen::Vector3d a = sphere.vertices[static_cast<std::size_t>(t[0])];
        const Eigen::Vector3d b = sphere.vertices[static_cast<std::size_t>(t[1])];
        const Eigen::Vector3d c = sphere.vertices[static_cast<std::size_t>(t[2])];
        EXPECT_GT((b - a).cross(c - a).dot(a - Eigen::Vector3d(1, 2, 3)), 0);
    }
}

TEST(SampleTree, every_leaf_encloses_its_triangles) {
    const TriangleMesh sphere = sample::sphere_surface({0, 0, 0}, 10, 3);
    const ObbTree tree = sample::median_tree(sphere, 4);
    std::size_t covered = 0;
    for (const ObbNode& node : tree.nodes)
        for (std::int32_t i = node.first; i < node.first + node.count; ++i, ++covered)
            for (const std::int32_t v :
                 sphere
                     .triangles[static_cast<std::size_t>(tree.triangle_order[static_cast<std::size_t>(i)])]) {
                const Eigen::Vector3f p = sphere.vertices[static_cast<std::size_t>(v)].cast<float>();
                EXPECT_TRUE(
                    ((node.axes * (p - node.center)).cwiseAbs().array() <= node.half_extents.array()).all());
            }
    EXPECT_EQ(covered, sphere.triangles.size());
}

}  // namespace
}  // namespace palpate
