// SPDX-License-Identifier: GPL-3.0-or-later
// Tissue at rest under forces as CalculiX has it: the same elements, law and loads, its own code.
#include <algorithm>
#include <gtest/gtest.h>
#include <string>

#include "formats/hyperelasticity/equilibrium.hpp"
#include "tests/formats/hyperelasticity/soft_blocks.hpp"
#include "tests/tools/fem/analytic/record.hpp"
#include "tests/tools/fem/blocks.hpp"
#include "tests/tools/fem/certificate/calculix.hpp"

namespace palpate {
namespace {

using namespace hyperelasticity;
using namespace test;

// Of the largest displacement: ccx balances forces to 1e-7 and prints 7 digits.
constexpr double judged_agreement = 1e-5;
constexpr double judged_settled = 1e-7;  // mm
constexpr int judged_steps = 500;

class EquilibriumByCalculiX : public ::testing::Test {
  protected:
    void SetUp() override {
        if (!calculix_is_installed()) GTEST_SKIP() << "calculix-ccx is not installed: no independent judge";
    }
};

// tests/benchmarks/large_deformation.py: 50 x 50 x 25 mm, held at sides and bottom.
DeformableBody block_of_the_benchmark(std::array<int, 3> cells, ElementOrder order) {
    DeformableBody body;
    body.mesh = block_mesh(cells, {50, 50, 25});
    jitter_interior(body.mesh, 0.15 * 50 / cells[0], 1);
    body.element_order = order;
    body.materials = {{1, liver_tissue}};
    body.fixed_nodes = nodes_where(body.mesh, [](const Eigen::Vector3d& p) {
        return p.z() == 0 || p.x() == 0 || p.y() == 0 || p.x() == 50 || p.y() == 50;
    });
    return body;
}

void expect_the_same_rest(const std::string& what, const DeformableBody& body, const Eigen::Vector3d& force,
                          double at_least) {
    Equilibrium ours(body);
    const auto patch = top_patch(body.mesh, 9);
    const Eigen::VectorXd loads = shared_force(ours.mesh(), patch, force);
    EXPECT_LT(ours.approach(loads, judged_settled, judged_steps), judged_settled) << what;
    const Eigen::VectorXd theirs =
        of_free_nodes(ours.mesh(), ask_calculix_neo_hookean(body, of_all_nodes(ours.mesh(), loads)));
    Eigen::Vector3d way = Eigen::Vector3d::Zero();
    for (const std::int32_t node : patch)
        way += ours.displacements().segment<3>(3 * ours.mesh().positions()[static_cast<std::size_t>(node)]) /
               static_cast<double>(patch.size());
    const double off = (ours.displacements() - theirs).cwiseAbs().maxCoeff() / theirs.cwiseAbs().maxCoeff();
    record(what + ": the patch's way (mm), relative difference of displacements",
           {way.x(), way.y(), way.z(), off});
    EXPECT_GT(way.dot(force.normalized()), at_least) << what;
    EXPECT_LT(off, judged_agreement) << what;
}

TEST_F(EquilibriumByCalculiX, agrees_on_linear_tetrahedra) {
    const DeformableBody body = block_of_the_benchmark({10, 10, 5}, ElementOrder::linear);
    expect_the_same_rest("press", body, {0, 0, -1.4}, 5);
    expect_the_same_rest("pull sideways", body, {1.2, 0, 0}, 5);
    expect_the_same_rest("lift", body, {0, 0, 1.5}, 9);
}

TEST_F(EquilibriumByCalculiX, agrees_on_quadratic_tetrahedra) {
    const DeformableBody body = block_of_the_benchmark({6, 6, 3}, ElementOrder::quadratic);
    expect_the_same_rest("press", body, {0, 0, -0.6}, 3);
    expect_the_same_rest("lift", body, {0, 0, 0.6}, 3);
}

}  // namespace
}  // namespace palpate
