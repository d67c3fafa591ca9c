// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/fem/sparse_cholesky.hpp"

#include <algorithm>
#include <cassert>
#include <cholmod.h>
#include <new>

#include "formats/model/errors.hpp"

namespace palpate {

struct SparseCholesky::Impl {
    cholmod_common common{};
    cholmod_factor* factor = nullptr;

    Impl() {
        cholmod_l_start(&common);
        common.supernodal = CHOLMOD_SUPERNODAL;
        common.final_ll = true;
        common.print = 0;
    }
    ~Impl() {
        cholmod_l_free_factor(&factor, &common);
        cholmod_l_finish(&common);
    }
    Impl(const Impl&) = delete;
    Impl& operator=(const Impl&) = delete;
};

namespace {

// A view of the matrix for CHOLMOD, which does not write to it.
cholmod_sparse view_of(const LowerSparse& matrix) {
    cholmod_sparse view{};
    view.nrow = static_cast<std::size_t>(matrix.rows());
    view.ncol = static_cast<std::size_t>(matrix.cols());
    view.nzmax = static_cast<std::size_t>(matrix.nonZeros());
    view.p = const_cast<std::int64_t*>(matrix.outerIndexPtr());
    view.i = const_cast<std::int64_t*>(matrix.innerIndexPtr());
    view.x = const_cast<double*>(matrix.valuePtr());
    view.stype = -1;
    view.itype = CHOLMOD_LONG;
    view.xtype = CHOLMOD_REAL;
    view.dtype = CHOLMOD_DOUBLE;
    view.sorted = 1;
    view.packed = 1;
    return view;
}

void require_success(const cholmod_common& common, const cholmod_factor* factor) {
    if (common.status == CHOLMOD_OUT_OF_MEMORY || common.status == CHOLMOD_TOO_LARGE || factor == nullptr)
        throw std::bad_alloc();
    if (common.status == CHOLMOD_NOT_POSDEF || factor->minor < factor->n)
        throw InvalidInput(
            {"stiffness matrix",
             "not positive definite at row " + std::to_string(factor->minor) + " of the elimination", "",
             "hold more nodes, or check the mesh for degenerate tetrahedra"});
}

}  // namespace

SparseCholesky::SparseCholesky(const LowerSparse& matrix, Elimination elimination)
    : impl_(std::make_unique<Impl>()) {
    cholmod_common& common = impl_->common;
    if (elimination == Elimination::as_given) {
        common.nmethods = 1;
        common.method[0].ordering = CHOLMOD_NATURAL;
        common.postorder = false;
    }
    cholmod_sparse view = view_of(matrix);
    impl_->factor = cholmod_l_analyze(&view, &common);
    if (impl_->factor == nullptr) throw std::bad_alloc();
    cholmod_l_factorize(&view, impl_->factor, &common);
    require_success(common, impl_->factor);
}

SparseCholesky::~SparseCholesky() = default;
SparseCholesky::SparseCholesky(SparseCholesky&&) noexcept = default;
SparseCholesky& SparseCholesky::operator=(SparseCholesky&&) noexcept = default;

Eigen::MatrixXd SparseCholesky::solve(const Eigen::MatrixXd& b) const {
    cholmod_dense right{};
    right.nrow = static_cast<std::size_t>(b.rows());
    right.ncol = static_cast<std::size_t>(b.cols());
    right.nzmax = right.nrow * right.ncol;
    right.d = right.nrow;
    right.x = const_cast<double*>(b.data());
    right.xtype = CHOLMOD_REAL;
    right.dtype = CHOLMOD_DOUBLE;
    cholmod_dense* x = cholmod_l_solve(CHOLMOD_A, impl_->factor, &right, &impl_->common);
    if (x == nullptr) throw std::bad_alloc();
    Eigen::MatrixXd result = Eigen::Map<Eigen::MatrixXd>(static_cast<double*>(x->x), b.rows(), b.cols());
    cholmod_l_free_dense(&x, &impl_->common);
    return result;
}

Eigen::MatrixXd SparseCholesky::trailing_factor(Eigen::Index size) const {
    const cholmod_factor& factor = *impl_->factor;
    assert(factor.is_super && factor.ordering == CHOLMOD_NATURAL);
    const auto* super = static_cast<const SuiteSparse_long*>(factor.super);
    const auto* row_offsets = static_cast<const SuiteSparse_long*>(factor.pi);
    const auto* value_offsets = static_cast<const SuiteSparse_long*>(factor.px);
    const auto* rows = static_cast<const SuiteSparse_long*>(factor.s);
    const auto* values = static_cast<const double*>(factor.x);
    const auto first = static_cast<SuiteSparse_long>(factor.n) - size;

    Eigen::MatrixXd trailing = Eigen::MatrixXd::Zero(size, size);
    for (std::size_t s = 0; s < factor.nsuper; ++s) {
        const SuiteSparse_long height = row_offsets[s + 1] - row_offsets[s];
        for (SuiteSparse_long column = std::max(super[s], first); column < super[s + 1]; ++column) {
            const SuiteSparse_long local = column - super[s];
            const double* source = values + value_offsets[s] + local * height;
            for (SuiteSparse_long r = local; r < height; ++r)
                trailing(rows[row_offsets[s] + r] - first, column - first) = source[r];
        }
    }
    return trailing;
}

}  // namespace palpate
