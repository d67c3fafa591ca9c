// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <gtest/gtest.h>
#include <limits>
#include <random>

#include "formats/elasticity/stiffness.hpp"
#include "formats/hyperelasticity/hyperelastic_mesh.hpp"
#include "formats/model/errors.hpp"
#include "tests/formats/hyperelasticity/soft_blocks.hpp"
#include "tests/tools/fem/blocks.hpp"

namespace palpate {
namespace {

using namespace hyperelasticity;
using namespace test;

// Of the largest force of its kind: sums of some hundred products keep 12 digits.
constexpr double sum_rounding = 1e-12;

Eigen::VectorXd seeded_displacements(Eigen::Index dofs, double amount, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(-amount, amount);
    return Eigen::VectorXd::NullaryExpr(dofs, [&] { return uniform(random); });
}

const Eigen::Matrix3d some_deformation =
    (Eigen::Matrix3d() << 1.2, 0.3, -0.1, 0.05, 0.8, 0.2, -0.15, 0.1, 1.1).finished();

double volume_of(const DeformableBody& body, std::int32_t region) {
    double six = 0;
    for (std::size_t t = 0; t < body.mesh.tetrahedra.size(); ++t)
        if (body.mesh.regions[t] == region) six += six_volume(body.mesh, t);
    return six / 6;
}

// The sum of f p_rest ᵀ over the nodes, which is the integral of P over the volume.
Eigen::Matrix3d virial_of(const DeformableBody& body, const Eigen::VectorXd& forces) {
    const auto positions = node_positions(body);
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    for (std::size_t node = 0; node < positions.size(); ++node)
        sum += forces.segment<3>(static_cast<Eigen::Index>(3 * node)) * positions[node].transpose();
    return sum;
}

TEST(HyperelasticMesh, at_rest_has_neither_energy_nor_forces) {
    for (const ElementOrder order : both_element_orders) {
        const HyperelasticMesh mesh(soft_block({3, 2, 2}, order));
        Eigen::VectorXd forces(mesh.dofs());
        EXPECT_NEAR(mesh.forces(Eigen::VectorXd::Zero(mesh.dofs()), forces), 0, 1e-15);
        EXPECT_LT(forces.cwiseAbs().maxCoeff(), 1e-15);  // N, where a strain of one makes some tenths
    }
}

TEST(HyperelasticMesh, forces_are_the_gradient_of_the_energy) {
    // By steps of 1e-4 mm: off by their square times the third derivative, and by 1e-16 over them, N.
    constexpr double step = 1e-4, error = 1e-8;
    for (const ElementOrder order : both_element_orders) {
        const HyperelasticMesh mesh(soft_block({2, 2, 2}, order));
        Eigen::VectorXd u = seeded_displacements(mesh.dofs(), 0.4, 2), forces(mesh.dofs()), unused = forces;
        ASSERT_LT(mesh.forces(u, forces), 100);
        ASSERT_GT(forces.cwiseAbs().maxCoeff(), 1e-2);
        for (Eigen::Index i = 0; i < mesh.dofs(); ++i) {
            const double here = u[i];
            u[i] = here + step;
            const double ahead = mesh.forces(u, unused);
            u[i] = here - step;
            const double behind = mesh.forces(u, unused);
            u[i] = here;
            EXPECT_NEAR(forces[i], (ahead - behind) / (2 * step), error);
        }
    }
}

TEST(HyperelasticMesh, turned_and_carried_away_costs_nothing) {
    const Eigen::Matrix3d R = Eigen::AngleAxisd(2.5, Eigen::Vector3d(1, -2, 3).normalized()).matrix();
    for (const ElementOrder order : both_element_orders) {
        const DeformableBody body = unheld_block({2, 3, 2}, order);
        const HyperelasticMesh mesh(body);
        Eigen::VectorXd forces(mesh.dofs());
        const Eigen::VectorXd u = sampled(body, [&](const Eigen::Vector3d& p) -> Eigen::Vector3d {
            return R * p - p + Eigen::Vector3d(70, -30, 20);
        });
        EXPECT_NEAR(mesh.forces(u, forces), 0, sum_rounding);
        EXPECT_LT(forces.cwiseAbs().maxCoeff(), sum_rounding);
    }
}

TEST(HyperelasticMesh, turning_what_is_deformed_turns_its_forces) {
    const Eigen::Matrix3d R = Eigen::AngleAxisd(-1.2, Eigen::Vector3d(2, 1, 1).normalized()).matrix();
    for (const ElementOrder order : both_element_orders) {
        const DeformableBody body = unheld_block({2, 2, 2}, order);
        const HyperelasticMesh mesh(body);
        const Eigen::VectorXd u = seeded_displacements(mesh.dofs(), 0.4, 5),
                              rest = sampled(body, [](const Eigen::Vector3d&p) { return p; });
        Eigen::VectorXd before(mesh.dofs()), after(mesh.dofs());
        const double energy = mesh.forces(u, before);
        const Eigen::VectorXd turned = (R * (rest + u).reshaped(3, mesh.dofs() / 3)).reshaped() - rest;
        EXPECT_NEAR(mesh.forces(turned, after), energy, sum_rounding * energy);
        EXPECT_LT((after - (R * before.reshaped(3, mesh.dofs() / 3)).reshaped()).cwiseAbs().maxCoeff(),
                  sum_rounding);
    }
}

TEST(HyperelasticMesh, forces_and_moments_of_what_nothing_holds_balance) {
    for (const ElementOrder order : both_element_orders) {
        const DeformableBody body = unheld_block({2, 2, 2}, order);
        const HyperelasticMesh mesh(body);
        const auto rest = node_positions(body);
        const Eigen::VectorXd u = seeded_displacements(mesh.dofs(), 0.4, 6);
        Eigen::VectorXd forces(mesh.dofs());
        mesh.forces(u, forces);
        Eigen::Vector3d force = Eigen::Vector3d::Zero(), moment = force;
        for (std::size_t node = 0; node < rest.size(); ++node) {
            const Eigen::Vector3d f = forces.segment<3>(static_cast<Eigen::Index>(3 * node));
            force += f;
            moment += (rest[node] + u.segment<3>(static_cast<Eigen::Index>(3 * node))).cross(f);
        }
        EXPECT_LT(force.norm(), sum_rounding);
        EXPECT_LT(moment.norm(), 10 * sum_rounding);  // at arms of 10 mm
    }
}

TEST(HyperelasticMesh, forces_are_the_stiffness_times_small_displacements_to_second_order) {
    for (const ElementOrder order : both_element_orders) {
        const DeformableBody body = soft_block({3, 2, 2}, order);
        const HyperelasticMesh mesh(body);
        const elasticity::LowerSparse K = elasticity::assemble_stiffness(
            body.mesh, body.materials, mesh.discretisation(), mesh.positions());
        const Eigen::VectorXd u = seeded_displacements(mesh.dofs(), 1, 3);
        const auto difference = [&](double part) {
            Eigen::VectorXd forces(mesh.dofs());
            mesh.forces(part * u, forces);
            return (forces - K.selfadjointView<Eigen::Lower>() * (part * u)).norm();
        };
        const Eigen::VectorXd linear = K.selfadjointView<Eigen::Lower>() * u;
        EXPECT_LT(difference(1e-3), 1e-2 * 1e-3 * linear.norm());
        // The next order, a thousandth of this one, stays within a hundredth.
        EXPECT_NEAR(difference(1e-3) / difference(0.5e-3), 4, 0.04);
        EXPECT_NEAR(difference(0.5e-3) / difference(0.25e-3), 4, 0.04);
    }
}

// The patch test: whatever the tetrahedra, a uniform deformation is in balance inside, stores V W(F), and its
// forces do the work of P(F).
TEST(HyperelasticMesh, uniform_deformation_has_uniform_stress) {
    for (const ElementOrder order : both_element_orders)
        for (const bool published : {true, false}) {
            DeformableBody body = unheld_block({3, 3, 3}, order);
            if (published) body.mesh = macneal_harder_cube();
            const HyperelasticMesh mesh(body);
            const Eigen::VectorXd u = sampled(
                body, [&](const Eigen::Vector3d& p) -> Eigen::Vector3d { return some_deformation * p - p; });
            Eigen::VectorXd forces(mesh.dofs());
            const double energy = mesh.forces(u, forces), volume = volume_of(body, 1);
            const Stressed stressed = neo_hookean(some_deformation, moduli_of(liver_tissue));
            EXPECT_NEAR(energy, volume * stressed.energy, sum_rounding * energy);
            EXPECT_LT((virial_of(body, forces) - volume * stressed.stress).cwiseAbs().maxCoeff(),
                      sum_rounding * volume * stressed.stress.norm());
            const auto outside = boundary_nodes(body);
            std::size_t inside = 0;
            for (std::int32_t node = 0; node < static_cast<std::int32_t>(mesh.positions().size()); ++node)
                if (!std::ranges::binary_search(outside, node)) {
                    ++inside;
                    EXPECT_LT(forces.segment<3>(3 * node).norm(),
                              sum_rounding * forces.cwiseAbs().maxCoeff());
                }
            EXPECT_GE(inside, 8U);
        }
}

TEST(HyperelasticMesh, each_region_answers_by_its_own_material) {
    const Material lump{.youngs_modulus = 0.06, .poissons_ratio = 0.3};
    for (const ElementOrder order : both_element_orders) {
        DeformableBody body = unheld_block({3, 2, 2}, order);
        for (std::size_t t = 0; t < body.mesh.tetrahedra.size(); t += 3) body.mesh.regions[t] = 7;
        body.materials.insert(body.materials.begin(), {7, lump});  // not in the order of regions
        const HyperelasticMesh mesh(body);
        Eigen::VectorXd forces(mesh.dofs());
        const double energy = mesh.forces(
            sampled(body,
                    [&](const Eigen::Vector3d& p) -> Eigen::Vector3d { return some_deformation * p - p; }),
            forces);
        const Stressed soft = neo_hookean(some_deformation, moduli_of(liver_tissue)),
                       stiff = neo_hookean(some_deformation, moduli_of(lump));
        EXPECT_NEAR(energy, volume_of(body, 1) * soft.energy + volume_of(body, 7) * stiff.energy,
                    sum_rounding * energy);
        EXPECT_LT(
            (virial_of(body, forces) - volume_of(body, 1) * soft.stress - volume_of(body, 7) * stiff.stress)
                .cwiseAbs()
                .maxCoeff(),
            sum_rounding * volume_of(body, 7) * stiff.stress.norm());
    }
}

TEST(HyperelasticMesh, energy_is_infinite_where_an_element_is_inside_out) {
    for (const ElementOrder order : both_element_orders) {
        const DeformableBody body = soft_block({2, 2, 2}, order);
        const HyperelasticMesh mesh(body);
        Eigen::VectorXd u = Eigen::VectorXd::Zero(mesh.dofs()), forces(mesh.dofs());
        const auto place = mesh.positions()[13];  // the middle of the block
        ASSERT_GE(place, 0);
        u[3 * place] = 12;  // mm, beyond the side
        EXPECT_EQ(mesh.forces(u, forces), std::numeric_limits<double>::infinity());
        u.setConstant(std::numeric_limits<double>::quiet_NaN());
        EXPECT_EQ(mesh.forces(u, forces), std::numeric_limits<double>::infinity());
    }
}

TEST(HyperelasticMesh, fixed_nodes_have_no_place_and_middles_of_held_edges_neither) {
    for (const ElementOrder order : both_element_orders) {
        const HyperelasticMesh mesh(soft_block({2, 2, 2}, order));
        std::int32_t next = 0;
        for (std::size_t node = 0; node < mesh.positions().size(); ++node)
            EXPECT_EQ(mesh.positions()[node], std::ranges::binary_search(mesh.discretisation().fixed_nodes,
                                                                         static_cast<std::int32_t>(node))
                                                  ? -1
                                                  : next++);
        EXPECT_EQ(mesh.dofs(), 3 * next);
    }
}

TEST(HyperelasticMesh, refuses_bad_tetrahedra_and_materials) {
    DeformableBody body = soft_block({2, 2, 2}, ElementOrder::linear);
    std::swap(body.mesh.tetrahedra[3][0], body.mesh.tetrahedra[3][1]);
    EXPECT_THROW(HyperelasticMesh{body}, InvalidInput);
    for (const Material& bad : {Material{0, 0.4}, Material{-1, 0.4}, Material{1, 0.5}, Material{1, -1},
                                Material{std::numeric_limits<double>::quiet_NaN(), 0.4}})
        EXPECT_THROW(HyperelasticMesh{soft_block({2, 2, 2}, ElementOrder::linear, bad)}, InvalidInput);
    body = soft_block({2, 2, 2}, ElementOrder::linear);
    body.mesh.regions[2] = 7;
    EXPECT_THROW(HyperelasticMesh{body}, InvalidInput);
}

}  // namespace
}  // namespace palpate
