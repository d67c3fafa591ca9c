// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <vector>

#include "formats/elasticity/stiffness.hpp"
#include "formats/hyperelasticity/equilibrium.hpp"
#include "formats/model/errors.hpp"
#include "tests/formats/hyperelasticity/soft_blocks.hpp"
#include "tests/runtime/allocation_trap.hpp"
#include "tests/tools/fem/blocks.hpp"

namespace palpate {
namespace {

using namespace hyperelasticity;
using namespace test;
using Eigen::VectorXd;

// A step that moves no node by more leaves the block within some tens of it from where it rests.
constexpr double settled = 1e-7;         // mm
constexpr double same_rest = 1e-5;       // mm
constexpr double rest_tolerance = 1e-7;  // N, of loads of tenths: the stiffness, some 1e-2 N/mm, times that
constexpr int most_steps = 400;

// N; half of it on the smaller block of quadratic elements.
const Eigen::Vector3d press(0, 0, -0.4), lift(0, 0, 0.4), pull(0.25, 0.1, 0);
const std::vector<Eigen::Vector3d> motions{press, lift, pull, Eigen::Vector3d{-0.1, 0.15, -0.2}};

// Of an odd number of unknowns, so that not every step that is remembered is aligned alike.
DeformableBody cushion(ElementOrder order = ElementOrder::linear) {
    return order == ElementOrder::linear ? soft_block({4, 4, 3}, order) : soft_block({3, 3, 2}, order);
}

VectorXd patch_load(const DeformableBody& body, const HyperelasticMesh& mesh, const Eigen::Vector3d& force) {
    const double part = body.element_order == ElementOrder::linear ? 1 : 0.5;
    return shared_force(mesh, top_patch(body.mesh, 5.5), part * force);
}

VectorXd rest_under(const DeformableBody& body, const VectorXd& loads) {
    Equilibrium tissue(body);
    EXPECT_LT(tissue.approach(loads, settled, most_steps), settled);
    return tissue.displacements();
}

double largest_difference(const VectorXd& a, const VectorXd& b) {
    return (a - b).cwiseAbs().maxCoeff();
}

VectorXd linear_answer(const DeformableBody& body, const HyperelasticMesh& mesh, const VectorXd& loads) {
    const Eigen::MatrixXd K(
        elasticity::assemble_stiffness(body.mesh, body.materials, mesh.discretisation(), mesh.positions()));
    return Eigen::MatrixXd(K.selfadjointView<Eigen::Lower>()).llt().solve(loads);
}

TEST(Equilibrium, internal_forces_are_the_loads) {
    for (const ElementOrder order : both_element_orders)
        for (const Eigen::Vector3d& force : motions) {
            const DeformableBody body = cushion(order);
            const HyperelasticMesh mesh(body);
            const VectorXd loads = patch_load(body, mesh, force), u = rest_under(body, loads);
            EXPECT_GT(u.cwiseAbs().maxCoeff(), 1);  // mm: of tens
            VectorXd internal(mesh.dofs());
            mesh.forces(u, internal);
            EXPECT_LT(largest_difference(internal, loads), rest_tolerance);
        }
}

// What holds a known displacement is answered by that displacement, where it is stable: sheared by half, but
// hardly pressed, for forces that keep their direction turn over what they press from all sides.
TEST(Equilibrium, finds_the_displacement_that_its_loads_hold) {
    for (const ElementOrder order : both_element_orders) {
        const DeformableBody body = cushion(order);
        const HyperelasticMesh mesh(body);
        const VectorXd u = of_free_nodes(mesh, sampled(body, [](const Eigen::Vector3d& p) -> Eigen::Vector3d {
                                             return {0.02 * p.z() * p.z(), 0.1 * p.z() * std::sin(p.x() / 8),
                                                     0.02 * p.z() * std::cos(p.y() / 12)};
                                         }));
        VectorXd loads(mesh.dofs());
        ASSERT_LT(mesh.forces(u, loads), 100);
        EXPECT_GT(u.cwiseAbs().maxCoeff(), 1.9);  // mm
        EXPECT_LT(largest_difference(rest_under(body, loads), u), same_rest);
    }
}

// The difference is of second order: halving the loads quarters it.
TEST(Equilibrium, of_small_loads_is_the_linear_answer) {
    for (const ElementOrder order : both_element_orders) {
        const DeformableBody body = cushion(order);
        const HyperelasticMesh mesh(body);
        const VectorXd loads = patch_load(body, mesh, press), linear = linear_answer(body, mesh, loads);
        const auto difference = [&](double part) {
            return (rest_under(body, part * loads) - part * linear).norm();
        };
        EXPECT_LT(difference(0.02), 0.03 * 0.02 * linear.norm());
        EXPECT_NEAR(difference(0.02) / difference(0.01), 4, 0.2);
    }
}

// Down to where the energy that is gained is lost in the rounding of the energy that is there.
TEST(Equilibrium, settles_under_loads_of_any_size) {
    const DeformableBody body = cushion();
    const HyperelasticMesh mesh(body);
    const VectorXd loads = patch_load(body, mesh, press), linear = linear_answer(body, mesh, loads);
    for (const double part : {1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-9}) {
        Equilibrium tissue(body);
        const double enough = 1e-4 * part * linear.cwiseAbs().maxCoeff();
        EXPECT_LT(tissue.approach(part * loads, enough, 30), enough) << part;
        EXPECT_LT((tissue.displacements() - part * linear).norm(), (part + 1e-3) * part * linear.norm())
            << part;
    }
}

TEST(Equilibrium, more_steps_change_nothing_that_has_settled) {
    const DeformableBody body = cushion();
    Equilibrium tissue(body);
    for (const Eigen::Vector3d& force : motions) {
        const VectorXd loads = patch_load(body, tissue.mesh(), force);
        tissue.approach(loads, settled, most_steps);
        const VectorXd once = tissue.displacements();
        tissue.approach(loads, 0, most_steps);
        EXPECT_LT(largest_difference(tissue.displacements(), once), same_rest);
    }
}

TEST(Equilibrium, is_the_same_whatever_went_before) {
    for (const ElementOrder order : both_element_orders) {
        const DeformableBody body = cushion(order);
        Equilibrium tissue(body);
        for (const Eigen::Vector3d& before : motions)
            for (const Eigen::Vector3d& force : motions) {
                const VectorXd loads = patch_load(body, tissue.mesh(), force);
                // Settled, on its way, or by more steps than rounding lets be of use.
                for (const int steps : {most_steps, 3}) {
                    tissue.approach(patch_load(body, tissue.mesh(), before), steps == 3 ? 0 : 1e-13, steps);
                    EXPECT_LT(tissue.approach(loads, settled, most_steps), settled);
                    EXPECT_LT(largest_difference(tissue.displacements(), rest_under(body, loads)), same_rest);
                }
            }
    }
}

TEST(Equilibrium, goes_on_from_where_it_was) {
    const DeformableBody body = cushion();
    Equilibrium at_once(body), by_and_by(body);
    const VectorXd loads = patch_load(body, at_once.mesh(), pull);
    at_once.approach(loads, 0, 12);
    for (int k = 0; k < 12; ++k) by_and_by.approach(loads, 0, 1);
    EXPECT_EQ(at_once.displacements(), by_and_by.displacements());
}

TEST(Equilibrium, goes_back_without_loads) {
    for (const ElementOrder order : both_element_orders) {
        const DeformableBody body = cushion(order);
        Equilibrium tissue(body);
        for (const Eigen::Vector3d& force : motions) {
            tissue.approach(patch_load(body, tissue.mesh(), force), settled, most_steps);
            tissue.approach(VectorXd::Zero(tissue.mesh().dofs()), settled, most_steps);
            EXPECT_LT(tissue.displacements().cwiseAbs().maxCoeff(), same_rest);
        }
    }
}

TEST(Equilibrium, at_rest_stays_there) {
    Equilibrium tissue(cushion());
    EXPECT_LT(tissue.approach(VectorXd::Zero(tissue.mesh().dofs()), settled, most_steps), settled);
    EXPECT_LT(tissue.displacements().cwiseAbs().maxCoeff(), settled);
}

// Bit for bit, after any number of steps.
TEST(Equilibrium, reset_is_as_good_as_new) {
    const DeformableBody body = cushion();
    ASSERT_EQ(HyperelasticMesh(body).dofs() % 2, 1);
    Equilibrium used(body);
    for (const int before : {1, 2, 7, 40}) {
        used.approach(patch_load(body, used.mesh(), lift), 0, before);
        used.reset();
        EXPECT_EQ(used.displacements(), VectorXd::Zero(used.mesh().dofs()));
        Equilibrium fresh(body);
        for (const Eigen::Vector3d& force : motions) {
            const VectorXd loads = patch_load(body, fresh.mesh(), force);
            EXPECT_EQ(used.approach(loads, settled, 25), fresh.approach(loads, settled, 25));
            EXPECT_EQ(used.displacements(), fresh.displacements());
        }
    }
    // A step that is too long is seen by the energy, which must not be that of before.
    Equilibrium fresh(body);
    used.approach(patch_load(body, used.mesh(), 10 * lift), 0, 25);
    used.reset();
    const VectorXd heavy = patch_load(body, used.mesh(), 3 * pull);
    for (Equilibrium* tissue : {&used, &fresh}) tissue->approach(heavy, 0, 1);
    EXPECT_EQ(used.displacements(), fresh.displacements());
}

TEST(Equilibrium, allocates_nothing_once_it_is_built) {
    for (const ElementOrder order : both_element_orders) {
        const DeformableBody body = cushion(order);
        Equilibrium tissue(body);
        const VectorXd loads = patch_load(body, tissue.mesh(), press);
        const AllocationTrap trap;
        tissue.approach(loads, settled, 40);
        tissue.reset();
        tissue.approach(loads, settled, 3);
        EXPECT_EQ(trap.count(), 0U);
    }
}

// W - f . u, up to the rounding of its two parts.
TEST(Equilibrium, no_step_raises_the_energy) {
    for (const ElementOrder order : both_element_orders) {
        const DeformableBody body = cushion(order);
        Equilibrium tissue(body);
        VectorXd unused(tissue.mesh().dofs());
        for (const Eigen::Vector3d& force : motions) {
            const VectorXd loads = patch_load(body, tissue.mesh(), force);
            const auto energy = [&] {
                return tissue.mesh().forces(tissue.displacements(), unused) -
                       loads.dot(tissue.displacements());
            };
            double before = energy();
            for (int step = 0; step < 100; ++step) {
                tissue.approach(loads, settled, 1);
                EXPECT_LE(energy(), before + 1e-11 * std::abs(before)) << step;
                before = energy();
            }
        }
    }
}

TEST(Equilibrium, turns_with_the_tissue_and_its_loads) {
    const Eigen::Matrix3d R = Eigen::AngleAxisd(1.9, Eigen::Vector3d(1, 2, -1).normalized()).matrix();
    const DeformableBody body = cushion();
    DeformableBody turned = body;
    for (Eigen::Vector3d& p : turned.mesh.rest_positions) p = R * p;
    const HyperelasticMesh mesh(body);
    const VectorXd loads = patch_load(body, mesh, lift);
    const auto turn = [&](const VectorXd& v) -> VectorXd {
        return (R * v.reshaped(3, v.size() / 3)).reshaped();
    };
    EXPECT_LT(largest_difference(rest_under(turned, turn(loads)), turn(rest_under(body, loads))), same_rest);
}

// Where a whole step would turn elements inside out.
TEST(Equilibrium, of_loads_beyond_all_measure_is_still_the_right_side_out) {
    const DeformableBody body = cushion();
    for (const double times : {10.0, 1e3, 1e9})
        for (const Eigen::Vector3d& force : motions) {
            Equilibrium tissue(body);
            const VectorXd loads = times * patch_load(body, tissue.mesh(), force);
            tissue.approach(loads, 1e-3, 50);
            VectorXd unused(tissue.mesh().dofs());
            EXPECT_LT(tissue.mesh().forces(tissue.displacements(), unused),
                      std::numeric_limits<double>::infinity());
            // And it comes back.
            tissue.approach(VectorXd::Zero(loads.size()), settled, 2000);
            EXPECT_LT(tissue.displacements().cwiseAbs().maxCoeff(), same_rest) << times;
        }
}

TEST(Equilibrium, loads_that_are_no_numbers_leave_it_where_it_was) {
    const DeformableBody body = cushion();
    Equilibrium tissue(body);
    VectorXd loads = patch_load(body, tissue.mesh(), press);
    tissue.approach(loads, settled, most_steps);
    const VectorXd before = tissue.displacements();
    loads[4] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_FALSE(tissue.approach(loads, settled, most_steps) < settled);
    EXPECT_EQ(tissue.displacements(), before);
}

TEST(Equilibrium, settles_with_a_lump_ten_thousand_times_as_stiff) {
    DeformableBody body = cushion();
    for (std::size_t t = 0; t < body.mesh.tetrahedra.size(); t += 5) body.mesh.regions[t] = 2;
    body.materials.push_back({2, {.youngs_modulus = 63, .poissons_ratio = 0.3}});
    const HyperelasticMesh mesh(body);
    const VectorXd loads = patch_load(body, mesh, press), u = rest_under(body, loads);
    VectorXd internal(mesh.dofs());
    mesh.forces(u, internal);
    EXPECT_LT(largest_difference(internal, loads), 1e4 * rest_tolerance);
}

TEST(Equilibrium, settles_where_hardly_any_volume_is_lost) {
    for (const double nu : {0.49, 0.499}) {
        DeformableBody body = cushion();
        body.materials[0].material.poissons_ratio = nu;
        const HyperelasticMesh mesh(body);
        const VectorXd loads = patch_load(body, mesh, press);
        Equilibrium tissue(body);
        EXPECT_LT(tissue.approach(loads, 1e-5, most_steps), 1e-5) << nu;
        VectorXd internal(mesh.dofs());
        mesh.forces(tissue.displacements(), internal);
        EXPECT_LT(largest_difference(internal, loads), 1e-2 * loads.cwiseAbs().maxCoeff()) << nu;
    }
}

TEST(Equilibrium, refuses_bad_tetrahedra_and_materials) {
    DeformableBody body = cushion();
    std::swap(body.mesh.tetrahedra[3][0], body.mesh.tetrahedra[3][1]);
    EXPECT_THROW(Equilibrium{body}, InvalidInput);
    for (const Material& bad : {Material{0, 0.4}, Material{1, 0.5}, Material{1, -1}})
        EXPECT_THROW(Equilibrium{soft_block({2, 2, 2}, ElementOrder::linear, bad)}, InvalidInput);
    body = cushion();
    body.mesh.regions[2] = 7;
    EXPECT_THROW(Equilibrium{body}, InvalidInput);
}

// Of its stiffness rounding may make a positive definite one.
TEST(Equilibrium, refuses_what_is_left_to_turn) {
    for (const ElementOrder order : both_element_orders) {
        DeformableBody body = unheld_block({4, 4, 3}, order);
        for (const std::int32_t node : {0, 1}) {
            EXPECT_THROW(Equilibrium{body}, InvalidInput);
            body.fixed_nodes.push_back(node);
        }
        EXPECT_THROW(Equilibrium{body}, InvalidInput);
    }
}

TEST(Equilibrium, refuses_what_is_too_near_to_losing_no_volume_for_its_factor) {
    EXPECT_THROW(Equilibrium(soft_block({3, 3, 3}, ElementOrder::linear, {6.3e-3, 0.5 - 1e-12})),
                 InvalidInput);
}

}  // namespace
}  // namespace palpate
