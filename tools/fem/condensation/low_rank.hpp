// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <array>
#include <optional>

namespace palpate::fem {

/// A matrix U Vᵀ of rank at most U's columns.
struct LowRank {
    Eigen::MatrixXd u, v;

    Eigen::Index rank() const { return u.cols(); }
    /// Numbers that U and V hold.
    Eigen::Index size() const { return u.size() + v.size(); }
};

/// How far an approximation may be from the matrix: Euclidean norm of every row's and every column's error.
struct LowRankTolerance {
    double row = 0, column = 0;
};

/// Factorises a matrix within the tolerance by pivoted Gram-Schmidt steps (Businger & Golub 1965), or returns
/// nothing if that takes full rank. 4 rows columns rank flops.
std::optional<LowRank> truncated(Eigen::MatrixXd matrix, const LowRankTolerance& tolerance);

/// Joins a matrix's four parts (0,0) (0,1) (1,0) (1,1) into one of the least rank within a further tolerance:
/// QR of the factors, then the singular values of what couples them (Grasedyck & Hackbusch 2003), the
/// smallest of them dropped while rows and columns allow.
LowRank joined(const std::array<const LowRank*, 4>& parts, const LowRankTolerance& tolerance);

}  // namespace palpate::fem
