// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <span>

#include "formats/model/compliance.hpp"
#include "formats/model/progress.hpp"

namespace palpate::fem {

/// Returns the rows of C that belong to contact nodes, 3|nodes| x 3m, mm/N; called from several threads.
using ComplianceRows = std::function<Eigen::MatrixXd(std::span<const std::int32_t> contact_nodes)>;

/// Compresses a surface compliance into blocks of low rank without ever holding it: rows come in panels of
/// one cluster each; each panel's blocks are truncated at once, and four neighbouring blocks are joined
/// wherever one of low rank takes less than they do. So which blocks are of low rank follows from the matrix,
/// not from distances. `accuracy` is the relative error (root mean square) of every row and column that the
/// blocks may add up to; `points` are the contact nodes' rest positions, mm. The same bytes at any number of
/// threads. Cost: the panels, and about 4 m r flops for each of their rows, r being a typical rank.
/// Source: Grasedyck & Hackbusch, "Construction and arithmetics of H-matrices", Computing 70 (2003).
///
/// Debian's hmat-oss (1.8.1) does not serve: it asks for a matrix block by block, so that a solve, which
/// gives a whole row, would be made anew for every block of that row; it is GPL, which the runtime that
/// queries C is not; and its matrices cannot be read in place from a file.
HierarchicalCompliance compress(std::span<const Eigen::Vector3d> points, const ComplianceRows& rows,
                                double accuracy, int threads, const ProgressCallback& progress);

}  // namespace palpate::fem
