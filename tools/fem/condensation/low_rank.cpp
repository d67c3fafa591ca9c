// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/fem/condensation/low_rank.hpp"

#include <algorithm>
#include <cblas.h>
#include <lapacke.h>
#include <vector>

#include "formats/model/errors.hpp"

namespace palpate::fem {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

// left = Q R, replacing left by Q.
MatrixXd orthonormalise(MatrixXd& left) {
    const auto rows = static_cast<lapack_int>(left.rows());
    const auto columns = static_cast<lapack_int>(left.cols());
    const lapack_int rank = std::min(rows, columns);
    if (rank == 0) return MatrixXd(0, columns);
    std::vector<double> reflectors(static_cast<std::size_t>(rank));
    LAPACKE_dgeqrf(LAPACK_COL_MAJOR, rows, columns, left.data(), rows, reflectors.data());
    const MatrixXd upper = left.topRows(rank).triangularView<Eigen::Upper>();
    left.conservativeResize(Eigen::NoChange, rank);
    LAPACKE_dorgqr(LAPACK_COL_MAJOR, rows, rank, rank, left.data(), rows, reflectors.data());
    return upper;
}

MatrixXd beside(const MatrixXd& left, const MatrixXd& right) {
    MatrixXd both(left.rows(), left.cols() + right.cols());
    both << left, right;
    return both;
}

MatrixXd product(const MatrixXd& a, const MatrixXd& b, bool transpose_b) {
    const Index columns = transpose_b ? b.rows() : b.cols();
    MatrixXd c = MatrixXd::Zero(a.rows(), columns);
    if (c.size() == 0 || a.cols() == 0) return c;
    cblas_dgemm(CblasColMajor, CblasNoTrans, transpose_b ? CblasTrans : CblasNoTrans,
                static_cast<blasint>(a.rows()), static_cast<blasint>(columns), static_cast<blasint>(a.cols()),
                1.0, a.data(), static_cast<blasint>(a.rows()), b.data(), static_cast<blasint>(b.rows()), 0.0,
                c.data(), static_cast<blasint>(c.rows()));
    return c;
}

}  // namespace

std::optional<LowRank> truncated(MatrixXd matrix, const LowRankTolerance& tolerance) {
    const Index rows = matrix.rows(), columns = matrix.cols();
    const Index most = std::min(rows, columns) - 1;
    MatrixXd q(rows, most), coefficients(columns, most);
    const double row_limit = tolerance.row * tolerance.row,
                 column_limit = tolerance.column * tolerance.column;
    Index rank = 0;
    for (;;) {
        Index pivot = 0;
        const double worst_column = matrix.colwise().squaredNorm().maxCoeff(&pivot);
        if (worst_column <= column_limit && matrix.rowwise().squaredNorm().maxCoeff() <= row_limit) break;
        if (rank == most) return std::nullopt;
        q.col(rank) = matrix.col(pivot).normalized();
        coefficients.col(rank).noalias() = matrix.transpose() * q.col(rank);
        matrix.noalias() -= q.col(rank) * coefficients.col(rank).transpose();
        ++rank;
    }
    return LowRank{q.leftCols(rank), coefficients.leftCols(rank)};
}

LowRank joined(const std::array<const LowRank*, 4>& parts, const LowRankTolerance& tolerance) {
    const auto& [p00, p01, p10, p11] = parts;
    MatrixXd top = beside(p00->u, p01->u), bottom = beside(p10->u, p11->u);
    MatrixXd left = beside(p00->v, p10->v), right = beside(p01->v, p11->v);
    const MatrixXd r_top = orthonormalise(top), r_bottom = orthonormalise(bottom),
                   r_left = orthonormalise(left), r_right = orthonormalise(right);
    const auto head = [](const MatrixXd& r, const LowRank* part) -> MatrixXd {
        return r.leftCols(part->rank());
    };
    const auto tail = [](const MatrixXd& r, const LowRank* part) -> MatrixXd {
        return r.rightCols(part->rank());
    };

    MatrixXd core(r_top.rows() + r_bottom.rows(), r_left.rows() + r_right.rows());
    core.topLeftCorner(r_top.rows(), r_left.rows()) = product(head(r_top, p00), head(r_left, p00), true);
    core.topRightCorner(r_top.rows(), r_right.rows()) = product(tail(r_top, p01), head(r_right, p01), true);
    core.bottomLeftCorner(r_bottom.rows(), r_left.rows()) =
        product(head(r_bottom, p10), tail(r_left, p10), true);
    core.bottomRightCorner(r_bottom.rows(), r_right.rows()) =
        product(tail(r_bottom, p11), tail(r_right, p11), true);

    const Index rows = core.rows(), columns = core.cols(), least = std::min(rows, columns);
    LowRank whole{MatrixXd::Zero(top.rows() + bottom.rows(), 0),
                  MatrixXd::Zero(left.rows() + right.rows(), 0)};
    if (least == 0) return whole;
    MatrixXd u(rows, least), vt(least, columns);
    Eigen::VectorXd values(least);
    if (LAPACKE_dgesdd(LAPACK_COL_MAJOR, 'S', static_cast<lapack_int>(rows), static_cast<lapack_int>(columns),
                       core.data(), static_cast<lapack_int>(rows), values.data(), u.data(),
                       static_cast<lapack_int>(rows), vt.data(), static_cast<lapack_int>(least)) != 0)
        throw SystemFailure({"LAPACK dgesdd", "did not converge", "", "report this mesh"});
    whole.u.resize(Eigen::NoChange, least);
    whole.v.resize(Eigen::NoChange, least);
    const MatrixXd v = vt.transpose();
    whole.u << product(top, u.topRows(top.cols()), false),
        product(bottom, u.bottomRows(bottom.cols()), false);
    whole.v << product(left, v.topRows(left.cols()), false),
        product(right, v.bottomRows(right.cols()), false);

    whole.u *= values.asDiagonal();
    Eigen::VectorXd row_errors = Eigen::VectorXd::Zero(whole.u.rows()),
                    column_errors = Eigen::VectorXd::Zero(whole.v.rows());
    Index rank = least;
    for (; rank > 0; --rank) {
        row_errors += whole.u.col(rank - 1).cwiseAbs2();
        column_errors += values[rank - 1] * values[rank - 1] * whole.v.col(rank - 1).cwiseAbs2();
        if (row_errors.maxCoeff() > tolerance.row * tolerance.row ||
            column_errors.maxCoeff() > tolerance.column * tolerance.column)
            break;
    }
    whole.u.conservativeResize(Eigen::NoChange, rank);
    whole.v.conservativeResize(Eigen::NoChange, rank);
    return whole;
}

}  // namespace palpate::fem
