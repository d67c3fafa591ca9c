// SPDX-License-Identifier: GPL-3.0-or-later
// Our displacements and reactions against those of CalculiX for the same press.
#include <Eigen/Cholesky>
#include <algorithm>
#include <gtest/gtest.h>

#include "tests/tools/fem/analytic/record.hpp"
#include "tests/tools/fem/blocks.hpp"
#include "tests/tools/fem/certificate/calculix.hpp"
#include "tests/tools/fem/compliances.hpp"
#include "tools/fem/condensation/condense.hpp"

namespace palpate::test {
namespace {

// ccx prints 7 digits, which is 5e-7 of an entry at worst and less of the largest one; the rest is two direct
// solvers' round-off. Ten times finer than what the project promises, 1e-5.
constexpr double agreement = 1e-6;

// An organ-like piece, 40 x 32 x 24 mm: a warped block of 5 760 irregular tetrahedra on a held base, with a
// stiff lump inside.
DeformableBody pressed_body(ElementOrder order) {
    DeformableBody body =
        held_block({12, 10, 8}, {40, 32, 24}, {.youngs_modulus = 6.3e-3, .poissons_ratio = 0.45});
    jitter_interior(body.mesh, 0.6, 17);
    for (Eigen::Vector3d& p : body.mesh.rest_positions)  // a dome on a flat base with slanting sides
        p = {p.x() + 0.15 * p.z() * std::sin(p.y() / 9), p.y() * (1 - 0.008 * p.z()),
             p.z() * (1 - 0.0004 * ((p.x() - 20) * (p.x() - 20) + (p.y() - 16) * (p.y() - 16)))};
    for (std::size_t t = 0; t < body.mesh.tetrahedra.size(); ++t) {
        Eigen::Vector3d centre = Eigen::Vector3d::Zero();
        for (const std::int32_t node : body.mesh.tetrahedra[t])
            centre += body.mesh.rest_positions[static_cast<std::size_t>(node)] / 4;
        if ((centre - Eigen::Vector3d(18, 15, 14)).norm() < 7) body.mesh.regions[t] = 2;
    }
    body.mesh.region_names.push_back({2, "lump", {0, 1, 0}});
    body.materials.push_back({2, {.youngs_modulus = 30e-3, .poissons_ratio = 0.4}});
    body.element_order = order;
    body.boundary = boundary_surface(body.mesh);
    std::ranges::set_difference(body.boundary.nodes, body.fixed_nodes,
                                std::back_inserter(body.contact_nodes));
    return body;
}

// The contact nodes on top that the tool takes with it.
std::vector<std::size_t> pressed_contacts(const DeformableBody& body) {
    std::vector<std::size_t> pressed;
    for (std::size_t k = 0; k < body.contact_nodes.size(); ++k) {
        const Eigen::Vector3d& p = body.mesh.rest_positions[static_cast<std::size_t>(body.contact_nodes[k])];
        if (p.z() > 15 && std::hypot(p.x() - 23, p.y() - 13) < 6) pressed.push_back(k);
    }
    return pressed;
}

// 3 mm inwards with a slip of 0.8 mm, mm.
const Eigen::Vector3d press(0.8, 0.3, -3);

Supports press_supports(const ElasticSystem& system) {
    Supports supports(system);
    const auto hold = [&](std::int32_t node, const Eigen::Vector3d& value) {
        for (std::int32_t c = 0; c < 3; ++c) supports.held[static_cast<std::size_t>(3 * node + c)] = true;
        supports.values.segment<3>(3 * node) = value;
    };
    for (const std::int32_t node : system.discretisation.fixed_nodes) hold(node, Eigen::Vector3d(0, 0, 0));
    for (const std::size_t k : pressed_contacts(system.body)) hold(system.body.contact_nodes[k], press);
    return supports;
}

struct Judgement {
    double displacement;  // worst difference over the largest displacement
    double force;         // difference of the force on the tool over its norm
    double reaction;      // worst difference of a nodal reaction over the largest
};

// ccx against the sparse solution of the whole system.
Judgement judge_sparse(const ElasticSystem& system, const Supports& supports, const CalculixAnswer& answer) {
    const Eigen::VectorXd u = solve(system, supports);
    Eigen::VectorXd f = nodal_forces(system, u);
    for (Eigen::Index dof = 0; dof < f.size(); ++dof)
        if (!supports.held[static_cast<std::size_t>(dof)]) f[dof] = 0;
    Eigen::Vector3d ours = Eigen::Vector3d::Zero(), theirs = ours;
    for (const std::size_t k : pressed_contacts(system.body)) {
        ours += f.segment<3>(3 * system.body.contact_nodes[k]);
        theirs += answer.forces.segment<3>(3 * system.body.contact_nodes[k]);
    }
    return {(u - answer.displacements).cwiseAbs().maxCoeff() / u.cwiseAbs().maxCoeff(),
            (ours - theirs).norm() / ours.norm(),
            (f - answer.forces).cwiseAbs().maxCoeff() / f.cwiseAbs().maxCoeff()};
}

// ccx against the condensed compliance: C_cc f = u_c, u_s = C_sc f.
Judgement judge_condensed(const DeformableBody& body, const CalculixAnswer& answer) {
    const Eigen::MatrixXd C = full(fem::condense_by_trailing_block(body, no_progress));
    std::vector<Eigen::Index> pressed;
    for (const std::size_t k : pressed_contacts(body))
        for (Eigen::Index c = 0; c < 3; ++c) pressed.push_back(3 * static_cast<Eigen::Index>(k) + c);
    const Eigen::VectorXd u_c = press.replicate(static_cast<Eigen::Index>(pressed.size() / 3), 1);
    const Eigen::VectorXd f = Eigen::MatrixXd(C(pressed, pressed)).llt().solve(u_c);
    const Eigen::VectorXd u_s = C(Eigen::all, pressed) * f;
    double difference = 0, reaction = 0;
    for (std::size_t k = 0; k < body.contact_nodes.size(); ++k)
        difference = std::max(difference, (u_s.segment<3>(3 * static_cast<Eigen::Index>(k)) -
                                           answer.displacements.segment<3>(3 * body.contact_nodes[k]))
                                              .cwiseAbs()
                                              .maxCoeff());
    Eigen::Vector3d ours = Eigen::Vector3d::Zero(), theirs = ours;
    Eigen::Index row = 0;
    for (const std::size_t k : pressed_contacts(body)) {
        const Eigen::Vector3d mine = f.segment<3>(row),
                              its = answer.forces.segment<3>(3 * body.contact_nodes[k]);
        ours += mine;
        theirs += its;
        reaction = std::max(reaction, (mine - its).cwiseAbs().maxCoeff());
        row += 3;
    }
    return {difference / u_s.cwiseAbs().maxCoeff(), (ours - theirs).norm() / ours.norm(),
            reaction / f.cwiseAbs().maxCoeff()};
}

class CalculiX : public ::testing::Test {
  protected:
    void SetUp() override {
        if (!calculix_is_installed()) GTEST_SKIP() << "calculix-ccx is not installed: no independent judge";
    }
};

void record_difference(const std::string& of, const Judgement& j) {
    record(of + ": relative difference of displacements, nodal reactions, force on the tool",
           {j.displacement, j.reaction, j.force});
}

void expect_agreement(const std::string& of, const Judgement& judgement) {
    record_difference(of, judgement);
    EXPECT_LT(judgement.displacement, agreement) << of;
    EXPECT_LT(judgement.reaction, agreement) << of;
    EXPECT_LT(judgement.force, agreement) << of;
}

void expect_agreement_on_a_press(ElementOrder order) {
    const ElasticSystem system = elastic_system(pressed_body(order));
    const Supports supports = press_supports(system);
    const CalculixAnswer answer = ask_calculix(system, supports);
    expect_agreement("sparse", judge_sparse(system, supports, answer));
    expect_agreement("condensed", judge_condensed(system.body, answer));
}

// The judge is sharp enough to see a modulus that is wrong by 1e-4.
void expect_a_wrong_modulus_to_be_seen(ElementOrder order) {
    ElasticSystem system = elastic_system(pressed_body(order));
    const Supports supports = press_supports(system);
    const CalculixAnswer answer = ask_calculix(system, supports);
    DeformableBody wrong = system.body;
    wrong.materials[1].material.youngs_modulus *= 1 + 1e-4;
    const Judgement judgement = judge_sparse(elastic_system(wrong), supports, answer);
    record_difference("lump stiffer by 1e-4", judgement);
    EXPECT_GT(judgement.displacement, agreement);
    EXPECT_GT(judgement.reaction, agreement);
    EXPECT_GT(judgement.force, agreement);
}

TEST_F(CalculiX, agrees_with_the_sparse_and_the_condensed_press_of_linear_tetrahedra) {
    expect_agreement_on_a_press(ElementOrder::linear);
}
TEST_F(CalculiX, agrees_with_the_sparse_and_the_condensed_press_of_quadratic_tetrahedra) {
    expect_agreement_on_a_press(ElementOrder::quadratic);
}
TEST_F(CalculiX, sees_a_modulus_of_linear_tetrahedra_that_is_off_by_one_in_ten_thousand) {
    expect_a_wrong_modulus_to_be_seen(ElementOrder::linear);
}
TEST_F(CalculiX, sees_a_modulus_of_quadratic_tetrahedra_that_is_off_by_one_in_ten_thousand) {
    expect_a_wrong_modulus_to_be_seen(ElementOrder::quadratic);
}

}  // namespace
}  // namespace palpate::test
