// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/fem/stiffness.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "formats/model/errors.hpp"
#include "tests/tools/fem/blocks.hpp"

namespace palpate {
namespace {

const Material tissue{.youngs_modulus = 6e-3, .poissons_ratio = 0.45};
const std::array<Eigen::Vector3d, 4> corner_points{
    Eigen::Vector3d{1, 2, 3}, {4, 2.5, 3}, {1.5, 5, 2.8}, {1.2, 2.1, 7}};

// Products of a dozen numbers of order one keep 13 digits.
constexpr double round_off = 1e-13;

TEST(TetElement, stiffness_annihilates_rigid_motions) {
    const auto K = tetrahedron_stiffness(corner_points, tissue, ElementOrder::linear);
    Eigen::Matrix<double, 12, 6> motions;
    for (int a = 0; a < 4; ++a)
        for (int axis = 0; axis < 3; ++axis) {
            const Eigen::Vector3d unit = Eigen::Vector3d::Unit(axis);
            motions.block<3, 1>(3 * a, axis) = unit;
            motions.block<3, 1>(3 * a, 3 + axis) = unit.cross(corner_points[static_cast<std::size_t>(a)]);
        }
    EXPECT_LT((K * motions).cwiseAbs().maxCoeff(), round_off);
}

TEST(TetElement, stiffness_is_symmetric_with_exactly_six_zero_eigenvalues) {
    const auto K = tetrahedron_stiffness(corner_points, tissue, ElementOrder::linear);
    EXPECT_LT((K - K.transpose()).cwiseAbs().maxCoeff(), round_off);
    const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(K).eigenvalues();
    EXPECT_LT(values.head(6).cwiseAbs().maxCoeff(), round_off);
    EXPECT_GT(values[6], 1e-6);
}

TEST(TetElement, energy_of_uniform_strain_equals_hookes_law) {
    // Uniaxial strain e along x stores V (lambda + 2 mu) e² / 2.
    const double e = 0.01, lambda = tissue.youngs_modulus * 0.45 / (1.45 * 0.1),
                 mu = tissue.youngs_modulus / 2.9;
    Eigen::Matrix<double, 12, 1> u = Eigen::Matrix<double, 12, 1>::Zero();
    for (int a = 0; a < 4; ++a) u[3 * a] = e * corner_points[static_cast<std::size_t>(a)].x();
    const Eigen::Vector3d a = corner_points[1] - corner_points[0], b = corner_points[2] - corner_points[0],
                          c = corner_points[3] - corner_points[0];
    const double expected = a.cross(b).dot(c) / 6 * (lambda + 2 * mu) * e * e / 2;
    EXPECT_NEAR(0.5 * u.dot(tetrahedron_stiffness(corner_points, tissue, ElementOrder::linear) * u), expected,
                1e-12 * expected);
}

TEST(Stiffness, assembly_equals_the_sum_of_scattered_elements) {
    auto body = test::held_block({2, 3, 2}, {4, 5, 6}, tissue);
    test::jitter_interior(body.mesh, 0.3, 1);
    const Eigen::MatrixXd assembled = test::full_stiffness(body);
    Eigen::MatrixXd scattered = Eigen::MatrixXd::Zero(assembled.rows(), assembled.cols());
    for (const Tetrahedron& tet : body.mesh.tetrahedra) {
        std::array<Eigen::Vector3d, 4> points;
        for (std::size_t c = 0; c < 4; ++c)
            points[c] = body.mesh.rest_positions[static_cast<std::size_t>(tet[c])];
        const auto K = tetrahedron_stiffness(points, tissue, ElementOrder::linear);
        for (int a = 0; a < 4; ++a)
            for (int b = 0; b < 4; ++b)
                scattered.block<3, 3>(3 * tet[static_cast<std::size_t>(a)],
                                      3 * tet[static_cast<std::size_t>(b)]) += K.block<3, 3>(3 * a, 3 * b);
    }
    EXPECT_LT((assembled - scattered).cwiseAbs().maxCoeff(), round_off);
}

TEST(Stiffness, refuses_a_material_out_of_bounds) {
    auto body = test::held_block({1, 1, 1}, {1, 1, 1}, {.youngs_modulus = 0, .poissons_ratio = 0.3});
    EXPECT_THROW(test::full_stiffness(body), InvalidInput);
    body.materials = {{1, {.youngs_modulus = 1, .poissons_ratio = 0.5}}};
    EXPECT_THROW(test::full_stiffness(body), InvalidInput);
    body.materials = {{1, {.youngs_modulus = 1, .poissons_ratio = -1}}};
    EXPECT_THROW(test::full_stiffness(body), InvalidInput);
}

TEST(Stiffness, refuses_a_region_without_material) {
    auto body = test::held_block({1, 1, 1}, {1, 1, 1}, tissue);
    body.mesh.regions[2] = 7;
    EXPECT_THROW(test::full_stiffness(body), InvalidInput);
}

TEST(Stiffness, refuses_an_inverted_tetrahedron_by_its_number) {
    auto body = test::held_block({1, 1, 1}, {1, 1, 1}, tissue);
    std::swap(body.mesh.tetrahedra[3][0], body.mesh.tetrahedra[3][1]);
    try {
        test::full_stiffness(body);
        FAIL() << "an inverted tetrahedron was accepted";
    } catch (const InvalidInput& error) {
        EXPECT_EQ(error.detail().culprit, "tetrahedron 3");
    }
}

}  // namespace
}  // namespace palpate
