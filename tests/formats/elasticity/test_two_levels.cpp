// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Cholesky>
#include <algorithm>
#include <gtest/gtest.h>
#include <iterator>
#include <memory>

#include "formats/elasticity/plausible_compliance.hpp"
#include "formats/elasticity/stiffness.hpp"
#include "formats/elasticity/two_levels.hpp"
#include "tests/tools/fem/blocks.hpp"

namespace palpate {
namespace {

using Eigen::Index;

// A slab that is held below, of quadratic elements.
DeformableBody slab(std::array<int, 3> cells) {
    DeformableBody body =
        test::held_block(cells, {60, 60, 10}, {.youngs_modulus = 5e-3, .poissons_ratio = 0.45});
    body.element_order = ElementOrder::quadratic;
    body.boundary = boundary_surface(body.mesh);
    body.contact_nodes.clear();
    std::ranges::set_difference(body.boundary.nodes, body.fixed_nodes,
                                std::back_inserter(body.contact_nodes));
    return body;
}

// Steps until the residual is a millionth.
template <typename Preconditioner>
Index steps(Eigen::ConjugateGradient<Eigen::SparseMatrix<double>, Eigen::Lower, Preconditioner>& gradients,
            const Eigen::SparseMatrix<double>& stiffness) {
    gradients.setTolerance(1e-6);
    gradients.compute(stiffness);
    const Eigen::VectorXd solved = gradients.solve(Eigen::VectorXd::LinSpaced(stiffness.rows(), -1, 1));
    EXPECT_EQ(gradients.info(), Eigen::Success) << solved.size();
    return gradients.iterations();
}

TEST(TwoLevels, take_a_third_of_the_steps_that_the_diagonal_takes) {
    const DeformableBody body = slab({12, 12, 3});
    const auto discretisation = elasticity::discretise(body);
    const auto positions =
        elasticity::number_free_nodes(discretisation.node_count, discretisation.fixed_nodes);
    const Eigen::SparseMatrix<double> stiffness =
        elasticity::assemble_stiffness(body.mesh, body.materials, discretisation, positions);
    Eigen::ConjugateGradient<Eigen::SparseMatrix<double>, Eigen::Lower> by_diagonal;
    Eigen::ConjugateGradient<Eigen::SparseMatrix<double>, Eigen::Lower, elasticity::TwoLevels> by_levels;
    by_levels.preconditioner().add_corners(body, discretisation, positions);
    EXPECT_LT(3 * steps(by_levels, stiffness), steps(by_diagonal, stiffness));
}

TEST(TwoLevels, judge_the_true_compliance_of_quadratic_elements_as_right) {
    DeformableBody body = slab({3, 3, 1});
    const Eigen::MatrixXd whole = test::full_stiffness(body);
    const auto discretisation = elasticity::discretise(body);
    const auto positions =
        elasticity::number_free_nodes(discretisation.node_count, discretisation.fixed_nodes);
    std::vector<Index> free, contact;
    for (Index node = 0; node < static_cast<Index>(positions.size()); ++node)
        for (Index axis = 0; axis < 3; ++axis)
            if (positions[static_cast<std::size_t>(node)] >= 0) free.push_back(3 * node + axis);
    const Eigen::MatrixXd inverse = Eigen::MatrixXd(whole(free, free))
                                        .llt()
                                        .solve(Eigen::MatrixXd::Identity(std::ssize(free), std::ssize(free)));
    for (const std::int32_t node : body.contact_nodes)
        for (Index axis = 0; axis < 3; ++axis)
            contact.push_back(3 * Index{positions[static_cast<std::size_t>(node)]} + axis);
    const std::size_t dofs = contact.size();
    const std::shared_ptr<float[]> entries(new float[dofs * dofs]);
    Eigen::Map<Eigen::MatrixXf>(entries.get(), std::ssize(contact), std::ssize(contact)) =
        inverse(contact, contact).cast<float>();
    body.compliance = DenseCompliance{static_cast<std::int32_t>(body.contact_nodes.size()),
                                      std::shared_ptr<const float>(entries, entries.get())};
    constexpr std::uint64_t draws = 10;
    for (std::uint64_t seed = 0; seed < draws; ++seed)
        EXPECT_NO_THROW(elasticity::require_answers_of_mesh(body, "slab", seed));
}

}  // namespace
}  // namespace palpate
