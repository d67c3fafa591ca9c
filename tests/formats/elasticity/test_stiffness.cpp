// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <gtest/gtest.h>
#include <random>

#include "formats/elasticity/stiffness.hpp"
#include "formats/model/errors.hpp"
#include "tests/tools/fem/blocks.hpp"

namespace palpate {
namespace {

using namespace elasticity;

const Material tissue{.youngs_modulus = 6e-3, .poissons_ratio = 0.45};
const std::array<Eigen::Vector3d, 4> corner_points{
    Eigen::Vector3d{1, 2, 3}, {4, 2.5, 3}, {1.5, 5, 2.8}, {1.2, 2.1, 7}};

// Products of a dozen numbers of order one keep 13 digits.
constexpr double round_off = 1e-13;

// The nodes of one element: its corners and, if quadratic, the middles of its edges.
std::vector<Eigen::Vector3d> element_nodes(ElementOrder order) {
    std::vector<Eigen::Vector3d> nodes(corner_points.begin(), corner_points.end());
    if (order == ElementOrder::quadratic)
        for (const auto& [a, b] : tetrahedron_edges)
            nodes.emplace_back((corner_points[a] + corner_points[b]) / 2);
    return nodes;
}

constexpr std::array both_orders{ElementOrder::linear, ElementOrder::quadratic};

TEST(TetElement, stiffness_annihilates_rigid_motions) {
    for (const ElementOrder order : both_orders) {
        const auto nodes = element_nodes(order);
        Eigen::MatrixXd motions(static_cast<Eigen::Index>(3 * nodes.size()), 6);
        for (std::size_t a = 0; a < nodes.size(); ++a)
            for (int axis = 0; axis < 3; ++axis) {
                const auto row = static_cast<Eigen::Index>(3 * a);
                const Eigen::Vector3d unit = Eigen::Vector3d::Unit(axis);
                motions.block<3, 1>(row, axis) = unit;
                motions.block<3, 1>(row, 3 + axis) = unit.cross(nodes[a]);
            }
        const Eigen::MatrixXd K = tetrahedron_stiffness(corner_points, tissue, order);
        EXPECT_LT((K * motions).cwiseAbs().maxCoeff(), round_off);
    }
}

TEST(TetElement, stiffness_is_symmetric_with_exactly_six_zero_eigenvalues) {
    for (const ElementOrder order : both_orders) {
        const Eigen::MatrixXd K = tetrahedron_stiffness(corner_points, tissue, order);
        EXPECT_EQ(K.rows(), order == ElementOrder::linear ? 12 : 30);
        EXPECT_LT((K - K.transpose()).cwiseAbs().maxCoeff(), round_off);
        const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(K).eigenvalues();
        EXPECT_LT(values.head(6).cwiseAbs().maxCoeff(), round_off);
        EXPECT_GT(values[6], 1e-6);  // N/mm; the stiffness's entries are about 1e-2
    }
}

// A quadratic displacement has a strain that is linear over the tetrahedron. With strains e_i at the corners,
// the integral of L_i L_j, V (1 + delta_ij) / 20, gives the energy in closed form, without a quadrature.
TEST(QuadraticTetrahedron, energy_of_a_quadratic_field_equals_its_closed_form) {
    const double lambda = tissue.youngs_modulus * 0.45 / (1.45 * 0.1), mu = tissue.youngs_modulus / 2.9;
    std::mt19937 random(8);
    std::uniform_real_distribution<double> uniform(-1, 1);
    for (int trial = 0; trial < 5; ++trial) {
        Eigen::Matrix3d slope = Eigen::Matrix3d::NullaryExpr([&] { return uniform(random); });
        std::array<Eigen::Matrix3d, 3> curvature;  // of each displacement component, symmetric
        for (auto& c : curvature) {
            c = Eigen::Matrix3d::NullaryExpr([&] { return uniform(random); });
            c = (c + c.transpose()).eval();
        }
        const auto nodes = element_nodes(ElementOrder::quadratic);
        Eigen::VectorXd u(30);
        for (std::size_t a = 0; a < nodes.size(); ++a) {
            const Eigen::Vector3d& p = nodes[a];
            for (std::size_t k = 0; k < 3; ++k)
                u[static_cast<Eigen::Index>(3 * a + k)] =
                    slope.row(static_cast<Eigen::Index>(k)).dot(p) + 0.5 * p.dot(curvature[k] * p);
        }
        const auto stress_work = [&](const Eigen::Matrix3d& strain) {
            return lambda * strain.trace() * strain.trace() + 2 * mu * strain.squaredNorm();
        };
        Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
        double work = 0;
        for (const Eigen::Vector3d& p : corner_points) {
            Eigen::Matrix3d gradient = slope;
            for (std::size_t k = 0; k < 3; ++k)
                gradient.row(static_cast<Eigen::Index>(k)) += (curvature[k] * p).transpose();
            const Eigen::Matrix3d strain = (gradient + gradient.transpose()) / 2;
            sum += strain;
            work += stress_work(strain);
        }
        const Eigen::Vector3d a = corner_points[1] - corner_points[0],
                              b = corner_points[2] - corner_points[0],
                              c = corner_points[3] - corner_points[0];
        const double expected = 0.5 * a.cross(b).dot(c) / 6 / 20 * (work + stress_work(sum));
        const Eigen::MatrixXd K = tetrahedron_stiffness(corner_points, tissue, ElementOrder::quadratic);
        EXPECT_NEAR(0.5 * u.dot(K * u), expected, 1e-12 * expected);
    }
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
    for (const ElementOrder order : both_orders) {
        auto body = test::held_block({2, 3, 2}, {4, 5, 6}, tissue);
        test::jitter_interior(body.mesh, 0.3, 1);
        body.element_order = order;
        body.mesh.regions[5] = 2;
        body.materials.push_back({2, {.youngs_modulus = 0.1, .poissons_ratio = 0.2}});
        const Eigen::MatrixXd assembled = test::full_stiffness(body);
        Eigen::MatrixXd scattered = Eigen::MatrixXd::Zero(assembled.rows(), assembled.cols());
        const Discretisation discretisation = discretise(body);
        for (std::size_t t = 0; t < body.mesh.tetrahedra.size(); ++t) {
            std::array<Eigen::Vector3d, 4> points;
            for (std::size_t c = 0; c < 4; ++c)
                points[c] = body.mesh.rest_positions[static_cast<std::size_t>(body.mesh.tetrahedra[t][c])];
            const auto K = tetrahedron_stiffness(points, body.materials[t == 5 ? 1 : 0].material, order);
            const auto nodes = nodes_of_element(discretisation, t);
            for (std::size_t a = 0; a < nodes.size(); ++a)
                for (std::size_t b = 0; b < nodes.size(); ++b)
                    scattered.block<3, 3>(3 * nodes[a], 3 * nodes[b]) +=
                        K.block<3, 3>(static_cast<Eigen::Index>(3 * a), static_cast<Eigen::Index>(3 * b));
        }
        EXPECT_LT((assembled - scattered).cwiseAbs().maxCoeff(), round_off);
    }
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

}  // namespace
}  // namespace palpate
