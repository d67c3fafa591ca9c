// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Core>
#include <gtest/gtest.h>

#include "formats/elasticity/discretisation.hpp"
#include "formats/elasticity/inner_nodes.hpp"
#include "tests/tools/fem/blocks.hpp"

namespace palpate {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr double rounding = 1e-5;  // of displacements, solved to 1e-6 of the residual
constexpr std::int32_t stiff = 2;

// A block of tissue, [0, 20] mm, whose nodes within lie anyhow; a corner of it is ten times as stiff.
DeformableBody block(ElementOrder order) {
    DeformableBody body =
        test::held_block({3, 3, 4}, {20, 20, 20}, {.youngs_modulus = 5e-3, .poissons_ratio = 0.45});
    test::jitter_interior(body.mesh, 1, 3);
    for (std::size_t t = 0; t < body.mesh.regions.size() / 4; ++t) body.mesh.regions[t] = stiff;
    body.materials.push_back({stiff, {.youngs_modulus = 5e-2, .poissons_ratio = 0.4}});
    body.element_order = order;
    body.boundary = boundary_surface(body.mesh);
    return body;
}

std::vector<Vector3f> on_surface(const DeformableBody& body, const Eigen::VectorXd& displacements) {
    std::vector<Vector3f> surface;
    for (const std::int32_t node : body.boundary.nodes)
        surface.push_back(displacements.segment<3>(3 * Eigen::Index{node}).cast<float>());
    return surface;
}

// The largest difference at a node of the mesh, mm.
double largest_error(const std::vector<Vector3f>& found, const Eigen::VectorXd& expected) {
    double largest = 0;
    for (std::size_t node = 0; node < found.size(); ++node)
        largest = std::max(
            largest,
            (found[node].cast<double>() - expected.segment<3>(3 * static_cast<Eigen::Index>(node))).norm());
    return largest;
}

class InnerNodes : public ::testing::TestWithParam<ElementOrder> {};

TEST_P(InnerNodes, of_a_uniform_body_carry_on_a_linear_field) {
    DeformableBody body = block(GetParam());
    body.materials = {{1, body.materials[0].material}, {stiff, body.materials[0].material}};
    const Eigen::VectorXd u = test::sampled(body, [](const Vector3d& p) {
        return Vector3d(1 + 0.3 * p.x() - 0.2 * p.z(), 0.1 * p.y(), 2 - 0.1 * p.x());
    });
    EXPECT_LT(largest_error(elasticity::InnerNodes(body).follow(on_surface(body, u)), u),
              rounding * u.lpNorm<Eigen::Infinity>());
}

INSTANTIATE_TEST_SUITE_P(LinearAndQuadratic, InnerNodes,
                         ::testing::Values(ElementOrder::linear, ElementOrder::quadratic));

// By the whole system: what is pressed at one node of the surface moves within as K u = f has it.
TEST(InnerNodesUnderAForce, are_where_the_whole_stiffness_has_them) {
    const DeformableBody body = block(ElementOrder::linear);
    Eigen::VectorXd forces =
        Eigen::VectorXd::Zero(3 * static_cast<Eigen::Index>(body.mesh.rest_positions.size()));
    const auto pressed = test::nodes_where(body.mesh, [](const Vector3d& p) { return p.z() == 20; });
    forces.segment<3>(3 * Eigen::Index{pressed[pressed.size() / 2]}) = Vector3d(0.02, 0, -0.2);  // N
    const Eigen::VectorXd u =
        test::solve_dense(body, body.fixed_nodes, Eigen::VectorXd::Zero(forces.size()), forces);
    ASSERT_GT(u.lpNorm<Eigen::Infinity>(), 1);
    const auto found = elasticity::InnerNodes(body).follow(on_surface(body, u));
    ASSERT_GT(found.size(), body.boundary.nodes.size());
    EXPECT_LT(largest_error(found, u), rounding * u.lpNorm<Eigen::Infinity>());
}

// All eight nodes of one cube are its surface.
TEST(InnerNodesOfASurfaceAlone, are_none) {
    DeformableBody body =
        test::held_block({1, 1, 1}, {1, 1, 1}, {.youngs_modulus = 5e-3, .poissons_ratio = 0.3});
    body.boundary = boundary_surface(body.mesh);
    const std::vector<Vector3f> lifted(body.boundary.nodes.size(), Vector3f(0, 0, 2));
    EXPECT_EQ(elasticity::InnerNodes(body).follow(lifted), lifted);
}

}  // namespace
}  // namespace palpate
