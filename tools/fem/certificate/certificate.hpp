// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "formats/model/body.hpp"

namespace palpate::fem {

/// Columns that a certificate re-solves, contact loads that it tries, and the seed that picks both.
inline constexpr std::int32_t certificate_columns = 16;
inline constexpr std::int32_t certificate_loads = 1000;
inline constexpr std::uint64_t certificate_seed = 20261;
/// Picks other columns and loads for verify; condense_hierarchically() tries both seeds' before.
inline constexpr std::uint64_t recheck_seed = 90210;

/// Some columns of C.
struct SampledColumns {
    std::vector<Eigen::Index> dofs;  ///< contact degrees of freedom
    Eigen::MatrixXd values;          ///< 3m x dofs.size(), mm/N, in double; empty where C was never in double
};

/// Picks contact degrees of freedom for `columns` columns; the same for the same seed.
std::vector<Eigen::Index> sampled_dofs(const DeformableBody& body, std::int32_t columns, std::uint64_t seed);

/// Worst difference of a stored column, one of `dofs`, to the same one solved again (3m x |dofs|), relative
/// to its largest entry.
double worst_column_error(const SurfaceCompliance& compliance, const std::vector<Eigen::Index>& dofs,
                          const Eigen::MatrixXd& solved);

/// Picks the columns of a certificate; `values` is left empty.
SampledColumns certificate_sample(const DeformableBody& body);

/// Certifies a freshly made compliance, in double (`columns`) and as stored. Columns and random contact loads
/// are solved again with a factorisation of its own, in another elimination order, with one step of iterative
/// refinement for the columns, so that an error of the condensation cannot hide; the largest eigenvalue of C
/// is taken from such solutions, the smallest from K_ss - K_si K_ii^-1 K_is, its inverse. Cost: two sparse
/// factorisations and about 1100 solutions.
Certificate certify(const DeformableBody& body, const SampledColumns& columns);

/// Rechecks a stored compliance from mesh, materials and fixed nodes alone: residual of `columns` re-solved
/// columns, asymmetry, reciprocity, error of `loads` random contact loads, eigenvalues. smallest_eigenvalue
/// is 0 if a dense matrix is not positive definite (LAPACK dpotrf in double); of a hierarchical one, see
/// smallest_patch_eigenvalue. Throws InvalidInput if the stiffness is singular. Cost: as certify(), and
/// 1/3 (3m)³ flops for a dense one.
Certificate recertify(const DeformableBody& body, std::int32_t columns, std::int32_t loads,
                      std::uint64_t seed);

}  // namespace palpate::fem
