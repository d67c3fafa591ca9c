// SPDX-License-Identifier: Apache-2.0
#include "runtime/haptics/contact/contact_lcp.hpp"

#include <algorithm>
#include <bitset>
#include <cmath>

namespace palpate::haptics {
namespace {

using Eigen::Index;

constexpr double dependent =
    1e-5;  // a pivot below this part of its diagonal is float32 noise of the compliance

}  // namespace

void ContactLcp::know(std::size_t row) noexcept {
    if (known_[row]) return;
    known_[row] = true;
    fill_(filler_, row);
}

// Extends the factor L L' of the active rows' submatrix by `row`; false if the row depends on them.
bool ContactLcp::append(std::size_t row) noexcept {
    const auto r = static_cast<Index>(row);
    const auto n = static_cast<Index>(count_);
    double pivot = A_(r, r);
    for (Index i = 0; i < n; ++i) {
        double value = A_(static_cast<Index>(order_[i]), r);
        for (Index j = 0; j < i; ++j) value -= L_(i, j) * L_(n, j);
        L_(n, i) = value / L_(i, i);
        pivot -= L_(n, i) * L_(n, i);
    }
    if (!(pivot > dependent * A_(r, r))) return false;
    L_(n, n) = std::sqrt(pivot);
    order_[count_++] = row;
    return true;
}

void ContactLcp::remove(std::size_t position) noexcept {
    const std::size_t old_count = count_;
    count_ = position;
    for (std::size_t i = position + 1; i < old_count; ++i) append(order_[i]);
}

// Lets `row`, which append() has just found to depend on the active ones, take over their forces until one of
// them bears none, and replaces that one. What it leaves to the others to give way stays the same, and it
// lowers the minimum, as `row` is violated. False if it bears against them: then no forces hold them all.
bool ContactLcp::exchange(std::size_t row) noexcept {
    const auto n = static_cast<Index>(count_);
    for (Index i = n - 1; i >= 0; --i) {  // the part of each active row in `row`: L' c = what append() left
        double value = L_(n, i);
        for (Index j = i + 1; j < n; ++j) value -= L_(j, i) * candidate_[j];
        candidate_[i] = value / L_(i, i);
    }
    double most = 0;
    std::size_t leaving = count_;
    for (std::size_t i = 0; i < count_; ++i) {
        const double part = candidate_[static_cast<Index>(i)];
        if (!(part > dependent) || pulls(order_[i])) continue;
        const double bears = f_[static_cast<Index>(order_[i])] / part;
        if (leaving < count_ && bears >= most) continue;
        most = bears;
        leaving = i;
    }
    if (leaving == count_) return false;
    for (std::size_t i = 0; i < count_; ++i) {
        double& force = f_[static_cast<Index>(order_[i])];
        force -= most * candidate_[static_cast<Index>(i)];
        if (!pulls(order_[i])) force = std::max(0.0, force);
    }
    f_[static_cast<Index>(order_[leaving])] = 0;
    remove(leaving);
    if (!append(row)) return false;
    f_[static_cast<Index>(row)] = most;
    return true;
}

// candidate = A_PP^-1 delta_P on the active rows P, in the factor's order.
void ContactLcp::solve_active() noexcept {
    const auto n = static_cast<Index>(count_);
    for (Index i = 0; i < n; ++i) {
        double value = delta_[static_cast<Index>(order_[i])];
        for (Index j = 0; j < i; ++j) value -= L_(i, j) * candidate_[j];
        candidate_[i] = value / L_(i, i);
    }
    for (Index i = n - 1; i >= 0; --i) {
        double value = candidate_[i];
        for (Index j = i + 1; j < n; ++j) value -= L_(j, i) * candidate_[j];
        candidate_[i] = value / L_(i, i);
    }
}

// Goes from the feasible f towards the active rows' own solution, dropping each row whose force would pull.
void ContactLcp::make_feasible() noexcept {
    while (count_ > 0) {
        solve_active();
        double step = 1;
        std::size_t blocking = count_;
        for (std::size_t i = 0; i < count_; ++i) {
            const double now = f_[static_cast<Index>(order_[i])];
            const double wanted = candidate_[static_cast<Index>(i)];
            if (wanted > 0 || pulls(order_[i])) continue;
            const double reach = now > 0 ? now / (now - wanted) : 0;
            if (blocking < count_ && reach >= step) continue;
            step = reach;
            blocking = i;
        }
        for (std::size_t i = 0; i < count_; ++i) {
            double& force = f_[static_cast<Index>(order_[i])];
            force += step * (candidate_[static_cast<Index>(i)] - force);
        }
        if (blocking == count_) return;
        f_[static_cast<Index>(order_[blocking])] = 0;
        remove(blocking);
    }
}

double ContactLcp::solve_filling(std::size_t rows, std::span<const std::size_t> active) noexcept {
    const auto n = static_cast<Index>(rows);
    count_ = 0;
    first_tangent_ = rows;
    known_.reset();
    f_.head(n).setZero();
    for (const std::size_t row : active) {
        know(row);
        append(row);
    }
    // From f = 0 the first step may drop warm rows one by one; what remains is feasible and optimal on
    // itself.
    make_feasible();
    return settle(rows);
}

double ContactLcp::solve_tangents(std::size_t rows, std::size_t tangents) noexcept {
    first_tangent_ = rows;
    for (std::size_t i = count_; i-- > 0;)  // those of an earlier call
        if (order_[i] >= rows) remove(i);
    for (std::size_t row = rows; row < rows + tangents; ++row) {
        known_[row] = true;
        f_[static_cast<Index>(row)] = 0;
        append(row);
    }
    make_feasible();
    return settle(rows + tangents);
}

// Lets rows in that are violated, until none is. Returns the residual.
double ContactLcp::settle(std::size_t rows) noexcept {
    const auto n = static_cast<Index>(rows);
    std::bitset<most_rows> set_aside;
    double worst = 0;
    for (std::size_t round = 0; round < 4 * rows + 8; ++round) {
        std::bitset<most_rows> is_active;
        for (std::size_t i = 0; i < count_; ++i) is_active[order_[i]] = true;
        double lowest = -tolerance;
        std::size_t entering = rows;
        worst = 0;
        for (Index k = 0; k < n; ++k) {
            double w = -delta_[k];
            for (std::size_t i = 0; i < count_; ++i) {
                const auto row = static_cast<Index>(order_[i]);
                w += A_(k, row) * f_[row];
            }
            const auto row = static_cast<std::size_t>(k);
            if (pulls(row) && !is_active[row]) continue;  // it depends on the others, which hold it
            worst = std::max(worst, is_active[row] ? std::abs(w) : -w);
            if (is_active[row] || set_aside[row] || w >= lowest) continue;
            lowest = w;
            entering = row;
        }
        if (entering == rows) break;
        // Where a pivot is noise, so is what the active rows leave to this one for the same reason.
        const auto row = static_cast<Index>(entering);
        know(entering);
        const double noise = dependent * A_(row, row) * f_.head(n).cwiseAbs().sum();
        if (!append(entering) && !(-lowest > noise && exchange(entering))) {
            set_aside[entering] = true;
            continue;
        }
        make_feasible();
        if (f_[row] > 0)
            set_aside.reset();
        else
            set_aside[entering] = true;
    }
    return worst;
}

}  // namespace palpate::haptics
