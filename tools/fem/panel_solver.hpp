// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "tools/fem/sparse_cholesky.hpp"

namespace palpate {

/// Rows of K^-1, many at once and at chosen columns, from a supernodal factor: only the supernodes that the
/// loads reach, and those that the wanted entries need, take part. Keeps a view of the factor.
class PanelSolver {
  public:
    /// `wanted` are rows of K.
    PanelSolver(const SparseCholesky& factor, std::span<const std::int64_t> wanted);

    /// Returns the rows `loaded` and columns `wanted` of K^-1, loaded x wanted: row i is the response to a unit
    /// load on row loaded[i] of K. Thread-safe. Memory: loads times size of K.
    Eigen::MatrixXd rows(std::span<const std::int64_t> loaded) const;

  private:
    std::vector<char> reached(std::span<const std::int64_t> rows) const;

    SupernodalView factor_;
    std::vector<std::int64_t> position_;        // row of L of each row of K
    std::vector<std::int64_t> supernode_of_;    // of each row of L
    std::vector<std::int64_t> wanted_;          // rows of L
    std::vector<char> needed_;                  // supernodes above a wanted row
};

}  // namespace palpate
