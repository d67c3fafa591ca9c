// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <span>

#include "formats/elasticity/stiffness.hpp"

namespace palpate::fem {

/// Who chooses the elimination order of a factorisation.
enum class Elimination {
    as_given,       ///< rows as they stand: the trailing block stays trailing
    fill_reducing,  ///< CHOLMOD's choice (AMD, METIS)
};

/// Thrown by a factorisation that meets a pivot that is not positive.
struct NotPositiveDefinite {
    std::int64_t row;  ///< of K
};

/// What a factorisation will take, known before it is made.
struct FactorForecast {
    double flops = 0;         ///< multiplications and additions
    double entries = 0;       ///< numbers of L as stored
    double work_entries = 0;  ///< numbers of the largest update between supernodes
};

/// The factor by its supernodes: neighbouring columns with the same rows below the diagonal, stored
/// together. Supernode s has the columns [first_column[s], first_column[s + 1]) and the rows
/// rows[row_offsets[s] ...], its own columns first; its values are column-major from value_offsets[s] on,
/// with as many rows as the supernode has.
struct SupernodalView {
    std::int64_t size = 0;
    std::span<const std::int64_t> first_column, row_offsets, value_offsets, rows;
    std::span<const std::int64_t> permutation;  ///< row of K at each row of L
    const double* values = nullptr;

    std::size_t supernode_count() const { return first_column.size() - 1; }
};

/// A supernodal Cholesky factor K = L Lᵀ (Chen, Davis, Hager, Rajamanickam 2008), 64-bit indices.
class SparseCholesky {
  public:
    using Block = Eigen::Map<Eigen::MatrixXd, 0, Eigen::OuterStride<>>;

    /// Factorises the symmetric matrix given by its lower triangle; throws NotPositiveDefinite or, if
    /// memory runs out, std::bad_alloc.
    SparseCholesky(const elasticity::LowerSparse& matrix, Elimination elimination);
    ~SparseCholesky();
    SparseCholesky(SparseCholesky&&) noexcept;
    SparseCholesky& operator=(SparseCholesky&&) noexcept;

    /// Analyses the pattern alone.
    static FactorForecast forecast(const elasticity::LowerSparse& matrix, Elimination elimination);

    /// Solves K x = b for all columns of b.
    Eigen::MatrixXd solve(const Eigen::MatrixXd& b) const;

    SupernodalView supernodes() const;

    /// The last `size` rows and columns of L where they lie (lower triangle; the upper one is undefined).
    /// They may be written to; L is then no longer a factor. Needs Elimination::as_given and a matrix whose
    /// column `size` from the end is full, so that they are one supernode; checked.
    Block trailing_block(Eigen::Index size);

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::fem
