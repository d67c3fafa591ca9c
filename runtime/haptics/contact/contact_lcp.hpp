// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <array>
#include <bitset>
#include <cstddef>
#include <span>

#include "formats/records/tick_result.hpp"

namespace palpate::haptics {

/// Solves unilateral contact: f >= 0, w = A f - delta >= 0, f . w = 0, for a symmetric positive definite A of
/// at most max_contacts rows (mm/N), and with them of up to most_tangents rows that pull as well as press, w
/// = 0, as friction does where it holds. That is the minimum of f.Af/2 - delta.f over f >= 0, found by the
/// active-set method of Lawson and Hanson (1974, ch. 23) with an appended Cholesky factor: each step lowers
/// the minimum, so it ends. A row that depends linearly on active ones (two contact points at one place)
/// takes the place of one of them. Realtime-safe; n³/3 multiply-adds from a cold start, n² from a right warm
/// start.
class ContactLcp {
  public:
    static constexpr std::size_t most_tangents = 48;
    static constexpr std::size_t most_rows = max_contacts + most_tangents;
    using Matrix = Eigen::Matrix<double, most_rows, most_rows>;
    using Vector = Eigen::Matrix<double, most_rows, 1>;
    static constexpr double tolerance = 1e-9;  ///< mm: a violation below this is rounding

    Matrix& matrix() noexcept { return A_; }
    Vector& gaps() noexcept { return delta_; }  ///< delta, mm

    /// Solves for the leading n rows, starting from the rows in `active` (may be empty). `fill(row)` writes
    /// the leading n entries of that column of matrix(), and is called once for each row that is to bear
    /// force: the others' columns need not be known. Returns the residual: the worst of -w where f = 0 and
    /// |w| where f > 0, mm.
    template <typename Fill>
    double solve(std::size_t n, std::span<const std::size_t> active, Fill fill) noexcept {
        fill_by(fill);
        return solve_filling(n, active);
    }
    /// The same with the whole matrix there.
    double solve(std::size_t n, std::span<const std::size_t> active) noexcept {
        return solve(n, active, [](std::size_t) {});
    }
    /// Solves on from there, or from another call of this, with `tangents` rows more, from row n on, that
    /// pull as well as press: their columns and rows of matrix() have been written. `fill` as before.
    template <typename Fill>
    double solve_with(std::size_t n, std::size_t tangents, Fill fill) noexcept {
        fill_by(fill);
        return solve_tangents(n, tangents);
    }
    const Vector& forces() const noexcept { return f_; }  ///< N, the leading n are valid

  private:
    template <typename Fill>
    void fill_by(Fill& fill) noexcept {
        filler_ = &fill;
        fill_ = [](void* filler, std::size_t row) { (*static_cast<Fill*>(filler))(row); };
    }
    double solve_tangents(std::size_t n, std::size_t tangents) noexcept;
    double solve_filling(std::size_t n, std::span<const std::size_t> active) noexcept;
    double settle(std::size_t n) noexcept;
    bool pulls(std::size_t row) const noexcept { return row >= first_tangent_; }
    void know(std::size_t row) noexcept;
    bool append(std::size_t row) noexcept;
    bool exchange(std::size_t row) noexcept;
    void remove(std::size_t position) noexcept;
    void solve_active() noexcept;
    void make_feasible() noexcept;

    Matrix A_, L_;
    Vector delta_, f_, candidate_;
    std::array<std::size_t, most_rows> order_{};  // active rows, in the order of L's
    std::size_t count_ = 0;
    std::bitset<most_rows> known_;  // columns of A
    std::size_t first_tangent_ = most_rows;
    void* filler_ = nullptr;
    void (*fill_)(void*, std::size_t) = nullptr;
};

}  // namespace palpate::haptics
