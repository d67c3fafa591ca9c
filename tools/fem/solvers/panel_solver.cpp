// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/fem/solvers/panel_solver.hpp"

#include <algorithm>
#include <cblas.h>
#include <utility>

namespace palpate::fem {

PanelSolver::PanelSolver(const SparseCholesky& factor, std::span<const std::int64_t> wanted)
    : factor_(factor.supernodes()),
      position_(static_cast<std::size_t>(factor_.size)),
      supernode_of_(static_cast<std::size_t>(factor_.size)) {
    for (std::size_t row = 0; row < position_.size(); ++row)
        position_[factor_.permutation[row]] = static_cast<std::int64_t>(row);
    for (std::size_t s = 0; s < factor_.supernode_count(); ++s)
        for (std::int64_t column = factor_.first_column[s]; column < factor_.first_column[s + 1]; ++column)
            supernode_of_[column] = static_cast<std::int64_t>(s);
    needed_.assign(factor_.supernode_count(), 0);
    for (const std::int64_t row : wanted) {
        wanted_.push_back(position_[row]);
        needed_[supernode_of_[wanted_.back()]] = 1;
    }
    needed_ = above(std::move(needed_));
}

// The marked supernodes and all on their ways to the root.
std::vector<char> PanelSolver::above(std::vector<char> marked) const {
    for (std::size_t s = 0; s < marked.size(); ++s) {
        const std::int64_t width = factor_.first_column[s + 1] - factor_.first_column[s];
        const std::int64_t first_below = factor_.row_offsets[s] + width;
        if (marked[s] == 0 || first_below == factor_.row_offsets[s + 1]) continue;
        const std::int64_t parent_row = factor_.rows[first_below];
        marked[supernode_of_[parent_row]] = 1;
    }
    return marked;
}

Eigen::MatrixXd PanelSolver::solve(std::span<const PanelLoad> entries, Eigen::Index load_count) const {
    // One column per row of L: what a supernode gathers and scatters lies in pieces of `count` numbers.
    const auto count = static_cast<blasint>(load_count);
    Eigen::MatrixXd x = Eigen::MatrixXd::Zero(count, factor_.size);
    std::vector<char> loaded(factor_.supernode_count(), 0);
    for (const PanelLoad& entry : entries) {
        const std::int64_t row = position_[entry.row];
        x(entry.load, row) += entry.value;
        loaded[supernode_of_[row]] = 1;
    }
    loaded = above(std::move(loaded));

    struct Supernode {
        double *own, *below;       // L's diagonal block and the block below it
        const std::int64_t* rows;  // below
        blasint width, height, below_count;
        std::int64_t first;
    };
    const auto supernode = [&](std::size_t s) {
        const auto width = static_cast<blasint>(factor_.first_column[s + 1] - factor_.first_column[s]);
        const auto height = static_cast<blasint>(factor_.row_offsets[s + 1] - factor_.row_offsets[s]);
        double* values = const_cast<double*>(factor_.values) + factor_.value_offsets[s];
        return Supernode{values,
                         values + width,
                         factor_.rows.data() + factor_.row_offsets[s] + width,
                         width,
                         height,
                         height - width,
                         factor_.first_column[s]};
    };
    std::int64_t most_below = 0;
    for (std::size_t s = 0; s < loaded.size(); ++s)
        if (loaded[s] != 0 || needed_[s] != 0)
            most_below = std::max<std::int64_t>(most_below, supernode(s).below_count);
    Eigen::MatrixXd gathered(count, most_below);
    for (std::size_t s = 0; s < loaded.size(); ++s) {
        if (loaded[s] == 0) continue;
        const Supernode n = supernode(s);
        cblas_dtrsm(CblasColMajor, CblasRight, CblasLower, CblasTrans, CblasNonUnit, count, n.width, 1.0,
                    n.own, n.height, x.col(n.first).data(), count);
        if (n.below_count == 0) continue;
        cblas_dgemm(CblasColMajor, CblasNoTrans, CblasTrans, count, n.below_count, n.width, 1.0,
                    x.col(n.first).data(), count, n.below, n.height, 0.0, gathered.data(), count);
        for (Eigen::Index r = 0; r < n.below_count; ++r) x.col(n.rows[r]) -= gathered.col(r);
    }
    for (std::size_t s = needed_.size(); s-- > 0;) {
        if (needed_[s] == 0) continue;
        const Supernode n = supernode(s);
        if (n.below_count > 0) {
            for (Eigen::Index r = 0; r < n.below_count; ++r) gathered.col(r) = x.col(n.rows[r]);
            cblas_dgemm(CblasColMajor, CblasNoTrans, CblasNoTrans, count, n.width, n.below_count, -1.0,
                        gathered.data(), count, n.below, n.height, 1.0, x.col(n.first).data(), count);
        }
        cblas_dtrsm(CblasColMajor, CblasRight, CblasLower, CblasNoTrans, CblasNonUnit, count, n.width, 1.0,
                    n.own, n.height, x.col(n.first).data(), count);
    }
    Eigen::MatrixXd result(count, static_cast<Eigen::Index>(wanted_.size()));
    for (std::size_t w = 0; w < wanted_.size(); ++w)
        result.col(static_cast<Eigen::Index>(w)) = x.col(wanted_[w]);
    return result;
}

}  // namespace palpate::fem
