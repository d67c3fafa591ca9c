// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "tools/fem/solvers/sparse_cholesky.hpp"

namespace palpate::fem {

/// An entry of a load: a force on one row of K.
struct PanelLoad {
    std::int64_t row;
    Eigen::Index load;
    double value;
};

/// Solves K x = f for many sparse loads at once and a subset of x, from a supernodal factor: only the
/// supernodes that the loads reach, and those that the wanted rows need, take part. Keeps a view of the
/// factor.
class PanelSolver {
  public:
    /// `wanted` are rows of K.
    PanelSolver(const SparseCholesky& factor, std::span<const std::int64_t> wanted);

    /// Solves for `count` loads, each the sum of its entries, and returns their solutions at the wanted rows,
    /// count x wanted. Thread-safe. Memory: loads times size of K.
    Eigen::MatrixXd solve(std::span<const PanelLoad> entries, Eigen::Index count) const;

  private:
    std::vector<char> above(std::vector<char> supernodes) const;

    SupernodalView factor_;
    std::vector<std::int64_t> position_;      // row of L of each row of K
    std::vector<std::int64_t> supernode_of_;  // of each row of L
    std::vector<std::int64_t> wanted_;        // rows of L
    std::vector<char> needed_;                // supernodes that a wanted row is in or below
};

}  // namespace palpate::fem
