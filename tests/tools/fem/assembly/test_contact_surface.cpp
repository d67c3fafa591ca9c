// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <gtest/gtest.h>

#include "formats/model/errors.hpp"
#include "tests/tools/fem/blocks.hpp"
#include "tests/tools/fem/compliances.hpp"
#include "tools/fem/condensation/condense.hpp"

namespace palpate {
namespace {

using namespace fem;

const Material soft{.youngs_modulus = 6e-3, .poissons_ratio = 0.45};

using test::no_progress;

DeformableBody block() {
    return test::held_block({4, 3, 3}, {8, 6, 7}, soft);
}

std::vector<std::int32_t> top_of(const DeformableBody& body) {
    return test::nodes_where(body.mesh, [](const Eigen::Vector3d& p) { return p.z() > 7 - 1e-9; });
}

class ContactSurfaceBy : public testing::TestWithParam<test::ExactMethod> {};

INSTANTIATE_TEST_SUITE_P(by, ContactSurfaceBy, testing::ValuesIn(test::exact_methods()), test::name_of);

// C belongs to K, not to the choice of nodes: a part of the surface has a part of the whole surface's C.
TEST_P(ContactSurfaceBy, of_a_part_has_the_rows_and_columns_of_the_whole_compliance) {
    DeformableBody whole = block();
    whole.boundary = boundary_surface(whole.mesh);
    std::ranges::set_difference(whole.boundary.nodes, whole.fixed_nodes,
                                std::back_inserter(whole.contact_nodes));
    DeformableBody part = block();
    part.contact_nodes = top_of(part);
    const Eigen::MatrixXd all = GetParam().compliance(whole), some = GetParam().compliance(part);
    std::vector<Eigen::Index> rows;
    for (const std::int32_t node : part.contact_nodes) {
        const auto block_of =
            std::ranges::lower_bound(whole.contact_nodes, node) - whole.contact_nodes.begin();
        for (Eigen::Index axis = 0; axis < 3; ++axis) rows.push_back(3 * block_of + axis);
    }
    ASSERT_EQ(some.rows(), static_cast<Eigen::Index>(rows.size()));
    const Eigen::MatrixXd expected = all(rows, rows);
    // Two factorisations of a matrix with condition 1e4 or so.
    EXPECT_LT((some - expected).cwiseAbs().maxCoeff(), 1e-11 * expected.cwiseAbs().maxCoeff());
}

TEST(ContactSurface, named_by_the_caller_is_kept_and_certified) {
    DeformableBody body = block();
    body.contact_nodes = top_of(body);
    const DeformableBody condensed = condensed_body(body, no_progress);
    EXPECT_EQ(condensed.contact_nodes, body.contact_nodes);
    EXPECT_EQ(condensed.certificate.sampled_columns, 16);
    EXPECT_LT(condensed.certificate.residual_double, 1e-10);
    EXPECT_EQ(condensed.certificate.free_dofs, 3 * (5 * 4 * 4 - 5 * 4));
}

TEST(ContactSurface, unnamed_is_every_free_surface_node) {
    const DeformableBody condensed = condensed_body(block(), no_progress);
    EXPECT_EQ(condensed.contact_nodes.size(), condensed.boundary.nodes.size() - condensed.fixed_nodes.size());
}

TEST(ContactSurface, with_a_fixed_or_interior_node_is_refused) {
    DeformableBody body = block();
    body.contact_nodes = {body.fixed_nodes.front()};
    EXPECT_THROW(condensed_body(body, no_progress), InvalidInput);
    const auto interior = test::nodes_where(body.mesh, [](const Eigen::Vector3d& p) {
        return p.x() > 1 && p.x() < 7 && p.y() > 1 && p.y() < 5 && p.z() > 1 && p.z() < 6;
    });
    body.contact_nodes = {interior.front()};
    EXPECT_THROW(condensed_body(body, no_progress), InvalidInput);
}

}  // namespace
}  // namespace palpate
