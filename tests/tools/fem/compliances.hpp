// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <gtest/gtest.h>
#include <string>
#include <string_view>
#include <vector>

#include "tools/fem/condensation/condense.hpp"

namespace palpate::test {

inline void no_progress(std::string_view, double) {}

/// One of the exact ways to a compliance, for tests that both must pass.
struct ExactMethod {
    std::string_view name;
    Eigen::MatrixXd (*compliance)(const DeformableBody& body);  ///< C with both triangles, mm/N
};

/// condense_by_trailing_block() and condense_by_solves().
std::vector<ExactMethod> exact_methods();

/// For INSTANTIATE_TEST_SUITE_P.
std::string name_of(const testing::TestParamInfo<ExactMethod>& method);

/// C with both triangles, 3m x 3m, mm/N.
Eigen::MatrixXd full(const fem::ExactCompliance& exact);

/// The stored matrix entry by entry, 3m x 3m, mm/N.
Eigen::MatrixXd entries_of(const SurfaceCompliance& compliance);

/// Degrees of freedom x, y, z of nodes.
std::vector<Eigen::Index> dofs_of(const std::vector<std::int32_t>& nodes);

/// A block of 80 nodes, 12 of them inside, with a stiff lump of two tetrahedra, prepared.
DeformableBody lumpy_block();

/// A block of 2197 nodes, 697 of them contact nodes, prepared.
DeformableBody large_block();

}  // namespace palpate::test
