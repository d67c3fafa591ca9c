// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>

namespace palpate {

/// Surface compliance C = (K^-1)_ss of a body held at its fixed nodes: u_s = C f_s, in mm/N, float32.
/// Dense, symmetric bit for bit, row-major, 3m x 3m; degrees of freedom are x, y, z of contact node 0, then
/// of contact node 1, ... The entries may live in memory or in a mapped file; `entries` keeps them alive.
struct DenseCompliance {
    std::int32_t node_count = 0;           ///< m
    std::shared_ptr<const float> entries;  ///< (3m)² values

    std::size_t dof_count() const { return 3 * static_cast<std::size_t>(node_count); }
    const float* row(std::size_t dof) const { return entries.get() + dof * dof_count(); }
};

/// What was measured about a compliance when it was made.
struct Certificate {
    double residual = 0;             ///< worst max-norm of (stored C column - re-solved column) / max|column|
    double residual_double = 0;      ///< the same before rounding to float32
    double asymmetry = 0;            ///< max |C - Cᵀ| / max |C| of the stored matrix; 0 by construction
    double smallest_eigenvalue = 0;  ///< of C, estimated, mm/N
    double largest_eigenvalue = 0;   ///< of C, estimated, mm/N
    double condition_number = 0;     ///< largest / smallest
    double reciprocity = 0;  ///< worst |aᵀCb - bᵀCa| / |aᵀCb| over random loads of the stored matrix
    std::int32_t sampled_columns = 0;  ///< columns that were re-solved
    std::int64_t free_dofs = 0;        ///< size of K after removing fixed nodes
};

}  // namespace palpate
