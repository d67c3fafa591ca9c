// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>

#include "formats/model/body.hpp"
#include "formats/model/progress.hpp"
#include "tools/fem/sparse_cholesky.hpp"

namespace palpate {

/// A surface compliance in double precision, with what its factor tells about it.
struct ExactCompliance {
    SparseCholesky factor;           ///< holds the memory of `lower`
    SparseCholesky::Block lower;     ///< lower triangle of C, 3m x 3m, mm/N; the upper one is undefined
    double smallest_eigenvalue = 0;  ///< of C, mm/N, from L_ss L_ssᵀ
    double largest_eigenvalue = 0;   ///< of C, mm/N
};

/// Computes the compliance of the contact nodes, C = (K^-1)_ss, exactly and without a solve: with the surface
/// eliminated last, K = L Lᵀ gives (K^-1)_ss = (L_ss L_ssᵀ)^-1, which is dpotri on the factor's trailing
/// block, in place. Reads body.mesh, materials, fixed_nodes and contact_nodes. Checks that no rigid motion is
/// left before factorising; throws InvalidInput otherwise. Cost: the sparse factor plus 2/3 (3m)³ flops;
/// (3m)² doubles besides the interior's factor. Equals the inverse of the condensed stiffness of Bro-Nielsen
/// (1998).
ExactCompliance condense(const DeformableBody& body, const ProgressCallback& progress);

/// Rounds to the stored form: float32, both triangles, symmetric bit for bit.
DenseCompliance to_stored(const Eigen::Ref<const Eigen::MatrixXd, 0, Eigen::OuterStride<>>& lower);

/// Completes a body from its mesh, materials and fixed nodes: boundary, contact nodes (boundary nodes that
/// are not fixed), compliance and certificate. The OBB tree stays empty.
DeformableBody condensed_body(DeformableBody body, const ProgressCallback& progress);

}  // namespace palpate
