// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <optional>

#include "tools/fem/solvers/free_system.hpp"

namespace palpate::fem {

/// The condensed stiffness S = K_ss - K_si K_ii^-1 K_is of the contact nodes (Bro-Nielsen 1998), as a map:
/// the inverse of C.
class InteriorElimination {
  public:
    /// Factorises K_ii; throws InvalidInput as factorise(). `system` must outlive this.
    InteriorElimination(const DeformableBody& body, const FreeSystem& system);

    /// Returns the forces, N, that hold the contact nodes at these displacements, mm; both 3m.
    Eigen::VectorXd surface_forces(const Eigen::VectorXd& displacements) const;

  private:
    const FreeSystem& system_;
    std::vector<std::int64_t> interior_rows_;
    std::optional<SparseCholesky> interior_;  // none if there is no free interior node
};

}  // namespace palpate::fem
