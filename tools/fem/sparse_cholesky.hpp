// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <memory>

#include "tools/fem/stiffness.hpp"

namespace palpate {

/// Who chooses the elimination order of a factorisation.
enum class Elimination {
    as_given,       ///< rows as they stand, no postordering: the trailing block stays trailing
    fill_reducing,  ///< CHOLMOD's choice (AMD, METIS)
};

/// A supernodal Cholesky factor K = L Lᵀ (Chen, Davis, Hager, Rajamanickam 2008), 64-bit indices.
class SparseCholesky {
  public:
    /// Factorises the symmetric matrix given by its lower triangle; throws InvalidInput with the row if it is
    /// not positive definite, std::bad_alloc if memory runs out.
    SparseCholesky(const LowerSparse& matrix, Elimination elimination);
    ~SparseCholesky();
    SparseCholesky(SparseCholesky&&) noexcept;
    SparseCholesky& operator=(SparseCholesky&&) noexcept;

    /// Solves K x = b for all columns of b.
    Eigen::MatrixXd solve(const Eigen::MatrixXd& b) const;

    /// Copies the last `size` rows and columns of L (lower triangle, zeros above); needs
    /// Elimination::as_given.
    Eigen::MatrixXd trailing_factor(Eigen::Index size) const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace palpate
