// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "formats/elasticity/discretisation.hpp"

namespace palpate::elasticity {

/// Free corner nodes beyond which no factor is made. Of a cube, which fills up most, one of 3 840 takes
/// 1.5 s and 55 MB, one of 21 168 two minutes and 775 MB.
inline constexpr std::size_t most_factorised_corners = 4000;

/// Preconditioner of conjugate gradients on the stiffness K: z = D^-1 r + T A^-1 Tᵀ r, D the diagonal of K.
/// Of quadratic elements A is the stiffness of the linear ones between the same corners and T takes a middle
/// node's displacement halfway between those of its edge's ends, so that A = Tᵀ K T; of linear ones the
/// second part is left out. It is for Eigen::ConjugateGradient, whose names it has. Source: Yserentant, "On
/// the multi-level splitting of finite element spaces", Numer. Math. 49 (1986).
class TwoLevels {
  public:
    /// Adds the second part for a body of quadratic elements, whose middle nodes `discretisation` numbers;
    /// `positions` numbers its free nodes as number_free_nodes() does. Leaves it out where the body has more
    /// than most_factorised_corners free corners or A has no Cholesky factor. Throws as assemble_stiffness().
    /// Cost: that factor, 0.25 s for 3 300 corners.
    void add_corners(const DeformableBody& body, const Discretisation& discretisation,
                     std::span<const std::int32_t> positions);

    template <typename Matrix>
    TwoLevels& analyzePattern(const Matrix&) {  // NOLINT(readability-identifier-naming): what Eigen calls
        return *this;
    }
    /// Takes the diagonal of K.
    template <typename Matrix>
    TwoLevels& factorize(const Matrix& stiffness) {
        diagonal_.compute(stiffness);
        return *this;
    }
    template <typename Matrix>
    TwoLevels& compute(const Matrix& stiffness) {
        return factorize(stiffness);
    }
    /// z of r; one solve with the factor.
    Eigen::VectorXd solve(const Eigen::VectorXd& residual) const;
    static Eigen::ComputationInfo info() { return Eigen::Success; }

  private:
    struct Corners {
        Eigen::SparseMatrix<double> to_all;  // T
        Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> factor;
    };
    Eigen::DiagonalPreconditioner<double> diagonal_;
    std::shared_ptr<const Corners> corners_;
};

}  // namespace palpate::elasticity
