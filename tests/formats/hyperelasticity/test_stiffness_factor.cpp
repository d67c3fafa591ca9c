// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "formats/elasticity/stiffness.hpp"
#include "formats/hyperelasticity/stiffness_factor.hpp"
#include "tests/formats/hyperelasticity/soft_blocks.hpp"
#include "tests/runtime/allocation_trap.hpp"

namespace palpate {
namespace {

using namespace hyperelasticity;
using namespace test;
using Eigen::VectorXd;

class StiffnessFactorOf : public testing::TestWithParam<ElementOrder> {
  protected:
    DeformableBody body_ = soft_block({4, 3, 2}, GetParam());
    HyperelasticMesh mesh_{body_};
    StiffnessFactor factor_{body_, mesh_};
    VectorXd moved_ = VectorXd::Zero(mesh_.dofs());
};

TEST_P(StiffnessFactorOf, any_forces_displaces_by_what_the_stiffness_holds_with_them) {
    const elasticity::LowerSparse stiffness = elasticity::assemble_stiffness(
        body_.mesh, body_.materials, mesh_.discretisation(), mesh_.positions());
    constexpr double float_rounding = 1e-4;  // a float's 6e-8, grown by the stiffness's condition number
    std::srand(1);
    for (int draw = 0; draw < 8; ++draw) {
        const VectorXd forces = VectorXd::Random(mesh_.dofs());
        factor_.solve(forces, moved_);
        const VectorXd held = stiffness.selfadjointView<Eigen::Lower>() * moved_;
        EXPECT_LT((held - forces).norm(), float_rounding * forces.norm());
    }
}

TEST_P(StiffnessFactorOf, a_body_solves_without_allocating) {
    const VectorXd forces = VectorXd::Ones(mesh_.dofs());
    const AllocationTrap trap;
    factor_.solve(forces, moved_);
    EXPECT_EQ(trap.count(), 0U);
}

INSTANTIATE_TEST_SUITE_P(Orders, StiffnessFactorOf, testing::ValuesIn(both_element_orders),
                         [](const auto& info) {
                             return info.param == ElementOrder::linear ? "linear" : "quadratic";
                         });

}  // namespace
}  // namespace palpate
