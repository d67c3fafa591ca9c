// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "tools/fem/condensation/low_rank.hpp"

namespace palpate {
namespace {

using namespace fem;
using Eigen::Index;
using Eigen::MatrixXd;

constexpr double factor_round_off = 1e-12;  // of entries of order 1
constexpr LowRankTolerance tight{.row = factor_round_off, .column = factor_round_off};

MatrixXd noise(Index rows, Index columns, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    return MatrixXd::NullaryExpr(rows, columns, [&] { return normal(random); });
}

MatrixXd of_rank(Index rows, Index columns, Index rank, std::uint64_t seed) {
    return noise(rows, rank, seed) * noise(columns, rank, seed + 100).transpose();
}

// Entries 1 / distance of two rows of points that do not touch: singular values fall geometrically.
MatrixXd smooth(Index rows, Index columns) {
    return MatrixXd::NullaryExpr(rows, columns, [&](Index i, Index j) {
        return 1 / (2 + static_cast<double>(i) / static_cast<double>(rows) +
                    static_cast<double>(j) / static_cast<double>(columns));
    });
}

double largest_row(const MatrixXd& m) {
    return m.rowwise().norm().maxCoeff();
}
double largest_column(const MatrixXd& m) {
    return m.colwise().norm().maxCoeff();
}

MatrixXd product(const LowRank& block) {
    return block.u * block.v.transpose();
}

TEST(LowRank, truncation_keeps_every_row_and_column_within_its_tolerance) {
    const MatrixXd matrix = smooth(60, 45);
    for (const LowRankTolerance& tolerance :
         {LowRankTolerance{1e-3, 1e-3}, LowRankTolerance{1e-6, 1e-2}, LowRankTolerance{1e-2, 1e-6}}) {
        const auto found = truncated(matrix, tolerance);
        ASSERT_TRUE(found);
        const MatrixXd error = matrix - product(*found);
        EXPECT_LE(largest_row(error), tolerance.row * (1 + factor_round_off));
        EXPECT_LE(largest_column(error), tolerance.column * (1 + factor_round_off));
        EXPECT_LT(found->rank(), 12);
    }
}

TEST(LowRank, truncation_recovers_the_exact_rank) {
    for (const Index rank : {1, 4, 9}) {
        const MatrixXd matrix = of_rank(50, 30, rank, 3);
        const auto found = truncated(matrix, tight);
        ASSERT_TRUE(found);
        EXPECT_EQ(found->rank(), rank);
        EXPECT_LT((matrix - product(*found)).cwiseAbs().maxCoeff(), factor_round_off);
    }
}

TEST(LowRank, truncation_of_next_to_nothing_has_rank_zero) {
    const auto found = truncated(1e-9 * noise(20, 10, 1), {1e-6, 1e-6});
    ASSERT_TRUE(found);
    EXPECT_EQ(found->rank(), 0);
    EXPECT_EQ(found->u.rows(), 20);
    EXPECT_EQ(found->v.rows(), 10);
}

TEST(LowRank, truncation_gives_up_on_noise_of_full_rank) {
    EXPECT_FALSE(truncated(noise(30, 20, 2), {1e-3, 1e-3}));
    EXPECT_FALSE(truncated(noise(20, 30, 2), {1e-3, 1e-3}));
}

// Four parts side by side, and their sum as one matrix.
struct Parts {
    std::array<LowRank, 4> parts;
    MatrixXd whole;

    Parts(std::array<Index, 2> rows, std::array<Index, 2> columns, std::array<Index, 4> ranks)
        : whole(rows[0] + rows[1], columns[0] + columns[1]) {
        for (std::size_t k = 0; k < 4; ++k) {
            const std::size_t i = k / 2, j = k % 2;
            parts[k] = {noise(rows[i], ranks[k], k), noise(columns[j], ranks[k], 10 + k)};
            whole.block(i == 0 ? 0 : rows[0], j == 0 ? 0 : columns[0], rows[i], columns[j]) =
                product(parts[k]);
        }
    }
    LowRank join(const LowRankTolerance& tolerance) const {
        return joined({&parts[0], &parts[1], &parts[2], &parts[3]}, tolerance);
    }
};

TEST(LowRank, joining_gives_the_four_parts_side_by_side) {
    const Parts p({20, 25}, {15, 18}, {2, 3, 1, 4});
    const LowRank whole = p.join(tight);
    EXPECT_LT((p.whole - product(whole)).cwiseAbs().maxCoeff(),
              factor_round_off * p.whole.cwiseAbs().maxCoeff() * 10);
    EXPECT_LE(whole.rank(), 10);
}

TEST(LowRank, joining_takes_parts_of_more_rank_than_they_have_rows) {
    const Parts p({4, 5}, {6, 3}, {6, 3, 6, 5});
    const LowRank whole = p.join(tight);
    EXPECT_LT((p.whole - product(whole)).cwiseAbs().maxCoeff(),
              factor_round_off * p.whole.cwiseAbs().maxCoeff() * 10);
    EXPECT_LE(whole.rank(), 9);
}

TEST(LowRank, joining_finds_the_rank_that_the_parts_have_in_common) {
    const MatrixXd u = noise(40, 5, 1), v = noise(36, 5, 2);
    const std::array<LowRank, 4> parts{
        LowRank{u.topRows(22), v.topRows(20)}, LowRank{u.topRows(22), v.bottomRows(16)},
        LowRank{u.bottomRows(18), v.topRows(20)}, LowRank{u.bottomRows(18), v.bottomRows(16)}};
    const LowRank whole = joined({&parts[0], &parts[1], &parts[2], &parts[3]}, {1e-10, 1e-10});
    EXPECT_EQ(whole.rank(), 5);
    EXPECT_LT((u * v.transpose() - product(whole)).cwiseAbs().maxCoeff(), 1e-10);
}

TEST(LowRank, joining_drops_what_rows_and_columns_allow_and_no_more) {
    const MatrixXd matrix = smooth(48, 40);
    std::array<LowRank, 4> parts;
    for (Index i = 0; i < 2; ++i)
        for (Index j = 0; j < 2; ++j)
            parts[static_cast<std::size_t>(2 * i + j)] =
                *truncated(matrix.block(24 * i, 20 * j, 24, 20), tight);
    for (double row = 1e-2; row > 1e-6; row /= 1.5) {  // the singular values fall by more at a time
        const LowRankTolerance tolerance{row, 2 * row};
        const LowRank whole = joined({&parts[0], &parts[1], &parts[2], &parts[3]}, tolerance);
        const MatrixXd error = matrix - product(whole);
        EXPECT_LE(largest_row(error), tolerance.row * (1 + 1e-6));
        EXPECT_LE(largest_column(error), tolerance.column * (1 + 1e-6));
        // One less of the best approximation breaks the tolerance.
        const Index less = whole.rank() - 1;
        const MatrixXd missed = matrix - whole.u.leftCols(less) * whole.v.leftCols(less).transpose();
        EXPECT_TRUE(largest_row(missed) > tolerance.row || largest_column(missed) > tolerance.column);
    }
}

TEST(LowRank, joining_takes_empty_parts) {
    for (const std::array<Index, 4>& ranks :
         {std::array<Index, 4>{0, 0, 0, 0}, std::array<Index, 4>{3, 0, 0, 0},
          std::array<Index, 4>{0, 2, 0, 0}, std::array<Index, 4>{0, 0, 2, 3},
          std::array<Index, 4>{0, 1, 1, 0}}) {
        const Parts p({12, 10}, {9, 11}, ranks);
        const LowRank whole = p.join(tight);
        EXPECT_EQ(whole.rank(), ranks[0] + ranks[1] + ranks[2] + ranks[3]);
        EXPECT_EQ(whole.u.rows(), 22);
        EXPECT_EQ(whole.v.rows(), 20);
        EXPECT_LT((p.whole - product(whole)).cwiseAbs().maxCoeff(), 20 * factor_round_off);
    }
}

}  // namespace
}  // namespace palpate
