// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/fem/solvers/sparse_cholesky.hpp"

#include <algorithm>
#include <cassert>
#include <cholmod.h>
#include <new>

#include "formats/model/errors.hpp"

namespace palpate::fem {

struct SparseCholesky::Impl {
    cholmod_common common{};
    cholmod_factor* factor = nullptr;

    explicit Impl(Elimination elimination) {
        cholmod_l_start(&common);
        common.supernodal = CHOLMOD_SUPERNODAL;
        common.final_ll = true;
        common.print = 0;
        if (elimination == Elimination::fill_reducing) return;
        common.nmethods = 1;
        common.method[0].ordering = CHOLMOD_NATURAL;
        common.postorder = false;
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
cholmod_sparse view_of(const elasticity::LowerSparse& matrix) {
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
        throw NotPositiveDefinite{static_cast<const std::int64_t*>(factor->Perm)[factor->minor]};
}

}  // namespace

SparseCholesky::SparseCholesky(const elasticity::LowerSparse& matrix, Elimination elimination)
    : impl_(std::make_unique<Impl>(elimination)) {
    cholmod_sparse view = view_of(matrix);
    impl_->factor = cholmod_l_analyze(&view, &impl_->common);
    if (impl_->factor == nullptr) throw std::bad_alloc();
    cholmod_l_factorize(&view, impl_->factor, &impl_->common);
    require_success(impl_->common, impl_->factor);
}

FactorForecast SparseCholesky::forecast(const elasticity::LowerSparse& matrix, Elimination elimination) {
    Impl impl(elimination);
    cholmod_sparse view = view_of(matrix);
    impl.factor = cholmod_l_analyze(&view, &impl.common);
    if (impl.factor == nullptr) throw std::bad_alloc();
    return {.flops = impl.common.fl,
            .entries = static_cast<double>(impl.factor->xsize),
            .work_entries = static_cast<double>(impl.factor->maxcsize)};
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

SupernodalView SparseCholesky::supernodes() const {
    const cholmod_factor& factor = *impl_->factor;
    const auto list = [](const void* data, std::size_t count) {
        return std::span(static_cast<const std::int64_t*>(data), count);
    };
    return {.size = static_cast<std::int64_t>(factor.n),
            .first_column = list(factor.super, factor.nsuper + 1),
            .row_offsets = list(factor.pi, factor.nsuper + 1),
            .value_offsets = list(factor.px, factor.nsuper + 1),
            .rows = list(factor.s, factor.ssize),
            .permutation = list(factor.Perm, factor.n),
            .values = static_cast<const double*>(factor.x)};
}

SparseCholesky::Block SparseCholesky::trailing_block(Eigen::Index size) {
    const SupernodalView view = supernodes();
    const std::size_t last = view.supernode_count() - 1;
    const std::int64_t height = view.row_offsets[last + 1] - view.row_offsets[last];
    const std::int64_t skipped = view.size - size - view.first_column[last];
    if (skipped < 0)
        throw SystemFailure({"CHOLMOD", "did not keep the surface in one supernode", "", "report this mesh"});
    double* values = static_cast<double*>(impl_->factor->x) + view.value_offsets[last];
    return {values + skipped * height + skipped, size, size, Eigen::OuterStride<>(height)};
}

}  // namespace palpate::fem
