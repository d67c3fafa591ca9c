// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <variant>
#include <vector>

#include "formats/records/eigen_layout.hpp"

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

/// A block of a hierarchical compliance: split into smaller ones, or stored.
struct ComplianceBlock {
    static constexpr std::int32_t dense = -1;

    std::int32_t first_child = 0;  ///< of a split block: index of its first part; 0 of a stored one
    std::int32_t rank = dense;     ///< of a stored block: r of U diag(s) Vᵀ, a multiple of 4, or `dense`
    std::int64_t values = 0;       ///< of a stored block: where its entries, or s, begin in `values`
    std::int64_t factors = 0;      ///< of one of low rank: where U, then V, begin in `factors`
};

/// The same matrix C by blocks of low rank (H-matrix; Hackbusch 1999), its lower half alone. Contact nodes
/// are put in an `order` in which neighbours are near; that order is halved `depth` times, so that cluster i
/// of level l holds the positions [begin(l, i), begin(l, i + 1)). blocks[0] is the whole matrix. A split
/// block of clusters I, J has the parts of their halves (I0,J0) (I0,J1) (I1,J0) (I1,J1); where I = J,
/// (I0,J1) is left out. A stored block holds the rows of I and the columns of J: `dense`, 3|I| x 3|J| values
/// row-major; or U diag(s) Vᵀ with U 3|I| x r, V 3|J| x r, both row-major in 16-bit integers, which keeps
/// about 2e-5 of a block's norm. Blocks with I = J at the last level are dense and symmetric bit for bit.
/// `values` are in mm/N, float32.
struct HierarchicalCompliance {
    static constexpr std::int32_t deepest = 20;     ///< levels that a reader takes
    static constexpr std::int32_t max_rank = 1024;  ///< that a product needs no allocation for

    static constexpr double coarsest_accuracy = 0.1;

    std::int32_t node_count = 0;          ///< m
    std::int32_t depth = 0;               ///< level of the smallest clusters
    double accuracy = 0;                  ///< relative error of displacements that was asked for
    std::vector<std::int32_t> order;      ///< contact node at each position
    std::vector<std::int32_t> positions;  ///< position of each contact node
    std::vector<ComplianceBlock> blocks;  ///< parts come after the block that they are of
    std::shared_ptr<const float> values;  ///< entries of dense blocks, s of the others
    std::size_t value_count = 0;
    std::shared_ptr<const std::int16_t> factors;  ///< U and V of blocks of low rank
    std::size_t factor_count = 0;

    std::int32_t begin(std::int32_t level, std::int32_t cluster) const {
        return static_cast<std::int32_t>((std::int64_t{node_count} * cluster) >> level);
    }
};

using SurfaceCompliance = std::variant<DenseCompliance, HierarchicalCompliance>;

/// A force on a contact node, N.
struct NodeForce {
    std::int32_t node = 0;
    Eigen::Vector3f force;
};

/// m, and the bytes of the stored values.
std::int32_t node_count(const SurfaceCompliance& compliance);
std::size_t value_bytes(const SurfaceCompliance& compliance);

/// The relative error that a sound compliance may have: 1e-6 for a dense one, which float32 rounds by 6e-8;
/// the accuracy that was asked for otherwise.
double allowed_error(const SurfaceCompliance& compliance);

/// Returns the displacement of contact node `a` per force on contact node `b`, 3 x 3, mm/N. `a` and `b` must
/// be in 0 ... m-1 (asserted). Realtime-safe, thread-safe; a few dozen ns, plus 9 r multiply-adds where the
/// block is of rank r.
Eigen::Matrix3f compliance_block(const SurfaceCompliance& compliance, std::int32_t a,
                                 std::int32_t b) noexcept;

/// Adds u_s = C_sc f_c to the displacements of all contact nodes, mm. Nodes may occur more than once; they
/// must be in 0 ... m-1, `displacements` has m entries (both asserted). Realtime-safe, thread-safe; reads
/// the touched rows of C, or the blocks that have a touched row or column.
void add_displacements(const SurfaceCompliance& compliance, std::span<const NodeForce> forces,
                       std::span<Eigen::Vector3f> displacements) noexcept;

}  // namespace palpate
