// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <memory>
#include <span>

#include "formats/model/body.hpp"
#include "formats/model/progress.hpp"
#include "tools/fem/condensation/condensation_plan.hpp"

namespace palpate::fem {

/// A surface compliance in double precision.
struct ExactCompliance {
    using Lower = Eigen::Map<const Eigen::MatrixXd, 0, Eigen::OuterStride<>>;

    std::shared_ptr<const void> memory;  ///< holds what `lower` shows
    Lower lower;                         ///< lower triangle of C, 3m x 3m, mm/N; the upper one is undefined
};

/// Computes the compliance of the contact nodes, C = (K^-1)_ss, without a solve: with the surface eliminated
/// last, K = L Lᵀ gives (K^-1)_ss = (L_ss L_ssᵀ)^-1, which is dpotri on the factor's trailing block, in
/// place. Reads body.mesh, materials, element_order, fixed_nodes, boundary and contact_nodes; throws
/// InvalidInput if a rigid motion is left (before factorising) or the stiffness is not positive definite.
/// Cost: the sparse factor, whose last part takes (3m)³/3 flops, plus 2/3 (3m)³. All of the dense kernels'
/// threads; the same bytes for the same number of them. Equals the inverse of the condensed stiffness of
/// Bro-Nielsen (1998).
ExactCompliance condense_by_trailing_block(const DeformableBody& body, const ProgressCallback& progress);

/// The same by solving for every contact degree of freedom, in panels, with the surface among the other nodes
/// of a nested dissection: 4 x 3m x (numbers in that factor) flops at most. Less than the trailing block's
/// where a mesh has few nodes inside. The same bytes at any number of `threads`, with the same number of the
/// dense kernels' threads, which factorise.
ExactCompliance condense_by_solves(const DeformableBody& body, int threads, const ProgressCallback& progress);

/// The same compressed, never holding C: see compress(). `accuracy` is that of random_contact_loads(), both
/// of the whole displacement field and of the loaded nodes', and of columns: those that the certificate and
/// verify try, with a tenth of it in reserve; on each load's nodes the result is positive definite. Throws
/// InvalidInput if no attempt of three gets there. Cost: the rows, and 2000 solutions an attempt.
HierarchicalCompliance condense_hierarchically(const DeformableBody& body, double accuracy, int threads,
                                               const ProgressCallback& progress);

/// Some columns of C, 3m x |dofs|, mm/N.
Eigen::MatrixXd columns_of(const ExactCompliance& exact, std::span<const Eigen::Index> dofs);

/// Rounds to the stored form: float32, both triangles, symmetric bit for bit.
DenseCompliance to_stored(const ExactCompliance& exact);

/// Sets contact nodes (those given, or every free surface node) and boundary of a body that has mesh,
/// materials, element order and fixed nodes, and checks that it can be condensed: throws as
/// contact_surface_of() and require_no_rigid_motion().
DeformableBody prepared_body(DeformableBody body);

/// Adds compliance and certificate to a prepared body, by the plan's method. The OBB tree stays empty.
DeformableBody condensed_body(DeformableBody body, const CondensationPlan& plan,
                              const ProgressCallback& progress);

/// All of it with the default options.
DeformableBody condensed_body(DeformableBody body, const ProgressCallback& progress);

}  // namespace palpate::fem
