// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <gtest/gtest.h>

#include "tests/tools/fem/blocks.hpp"
#include "tests/tools/fem/compliances.hpp"
#include "tools/fem/certificate/contact_loads.hpp"
#include "tools/fem/solvers/free_system.hpp"

namespace palpate {
namespace {

using namespace fem;
using Eigen::Index;
using Eigen::MatrixXd;

// A tall block of 10 000 nodes, about 3 000 of them contact nodes: bending makes it far softer across than
// along.
DeformableBody tall_block() {
    return prepared_body(
        test::held_block({12, 12, 60}, {24, 24, 80}, {.youngs_modulus = 6e-3, .poissons_ratio = 0.45}));
}

// Worst errors over random contact loads that neither the compression nor the certificate tries.
LoadError worst_error(const DeformableBody& body, const SurfaceCompliance& compliance) {
    constexpr std::int32_t count = 1000;
    constexpr std::uint64_t seed = 77;
    const FreeSystem system = assemble_free_system(body, NodeOrder::nested_dissection);
    const SparseCholesky factor = factorise(body, system, Elimination::fill_reducing);
    const auto contact_dofs = static_cast<Index>(system.contact_rows.size());
    LoadError worst;
    const std::vector<ContactLoad> loads = random_contact_loads(body, count, seed);
    constexpr std::size_t batch = 100;
    for (std::size_t first = 0; first < loads.size(); first += batch) {
        MatrixXd forces = MatrixXd::Zero(system.stiffness.rows(), batch);
        for (std::size_t k = 0; k < batch; ++k)
            for (const NodeForce& force : loads[first + k])
                for (Index axis = 0; axis < 3; ++axis)
                    forces(system.contact_rows[static_cast<std::size_t>(3 * force.node + axis)],
                           static_cast<Index>(k)) += double{force.force[axis]};
        const MatrixXd u = factor.solve(forces);
        for (std::size_t k = 0; k < batch; ++k) {
            Eigen::VectorXd exact(contact_dofs);
            for (Index dof = 0; dof < contact_dofs; ++dof)
                exact[dof] = u(system.contact_rows[static_cast<std::size_t>(dof)], static_cast<Index>(k));
            const LoadError error = error_of(compliance, loads[first + k], exact);
            worst.surface = std::max(worst.surface, error.surface);
            worst.contact = std::max(worst.contact, error.contact);
        }
    }
    return worst;
}

TEST(HierarchicalCondensation, meets_its_accuracy_on_contacts_that_it_has_not_seen) {
    const DeformableBody body = tall_block();
    ASSERT_GE(body.contact_nodes.size(), 3000U);
    constexpr double accuracy = 1e-3;
    const SurfaceCompliance compliance = condense_hierarchically(body, accuracy, 2, test::no_progress);
    const LoadError worst = worst_error(body, compliance);
    EXPECT_LT(worst.surface, accuracy);
    EXPECT_LT(worst.contact, accuracy);
    // More accurate by far would be a waste of bytes.
    EXPECT_GT(std::max(worst.surface, worst.contact), accuracy / 20);
    const double dense = 4 * 9 * static_cast<double>(body.contact_nodes.size() * body.contact_nodes.size());
    EXPECT_LT(static_cast<double>(value_bytes(compliance)), dense / 4);
}

}  // namespace
}  // namespace palpate
