// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Cholesky>
#include <gtest/gtest.h>
#include <random>

#include "tests/tools/fem/compliances.hpp"
#include "tools/fem/solvers/free_system.hpp"
#include "tools/fem/solvers/panel_solver.hpp"

namespace palpate {
namespace {

using namespace fem;
using Eigen::Index;
using Eigen::MatrixXd;

// Two factorisations of a matrix of condition 1e4 or so.
constexpr double panel_tolerance = 1e-11;

struct PanelSetting {
    DeformableBody body = test::lumpy_block();
    FreeSystem system = assemble_free_system(body, NodeOrder::nested_dissection);
    SparseCholesky factor = factorise(body, system, Elimination::as_given);
    Eigen::LLT<MatrixXd> dense{MatrixXd(MatrixXd(system.stiffness).selfadjointView<Eigen::Lower>())};

    Index size() const { return system.stiffness.rows(); }
};

// Solutions at the wanted rows, loads x wanted, by a dense factorisation.
MatrixXd expected(const PanelSetting& s, const std::vector<std::int64_t>& wanted,
                  const std::vector<PanelLoad>& entries, Index count) {
    MatrixXd loads = MatrixXd::Zero(s.size(), count);
    for (const PanelLoad& entry : entries) loads(entry.row, entry.load) += entry.value;
    return s.dense.solve(loads)(wanted, Eigen::all).transpose();
}

void expect_dense_solution(const PanelSetting& s, const std::vector<std::int64_t>& wanted,
                           const std::vector<PanelLoad>& entries, Index count) {
    const MatrixXd found = PanelSolver(s.factor, wanted).solve(entries, count);
    const MatrixXd solution = expected(s, wanted, entries, count);
    ASSERT_EQ(found.rows(), solution.rows());
    ASSERT_EQ(found.cols(), solution.cols());
    EXPECT_LT((found - solution).cwiseAbs().maxCoeff(), panel_tolerance * solution.cwiseAbs().maxCoeff());
}

TEST(PanelSolver, finds_one_row_of_one_load) {
    const PanelSetting s;
    for (const std::int64_t loaded : {std::int64_t{0}, s.size() / 2, s.size() - 1})
        for (const std::int64_t wanted : {std::int64_t{0}, s.size() / 3, s.size() - 1})
            expect_dense_solution(s, {wanted}, {{loaded, 0, 2.5}}, 1);
}

TEST(PanelSolver, finds_scattered_rows_of_scattered_loads) {
    const PanelSetting s;
    std::mt19937_64 random(7);
    const auto row = [&] {
        return static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(s.size()));
    };
    for (int round = 0; round < 10; ++round) {
        std::vector<std::int64_t> wanted;
        for (int w = 0; w < 5; ++w) wanted.push_back(row());  // in no order, some perhaps twice
        std::vector<PanelLoad> entries;
        for (Index load = 0; load < 4; ++load)
            for (int e = 0; e < 3; ++e)
                entries.push_back({row(), load, static_cast<double>(1 + random() % 9) - 5.5});
        expect_dense_solution(s, wanted, entries, 4);
    }
}

TEST(PanelSolver, finds_rows_and_loads_that_share_supernodes) {
    const PanelSetting s;
    const SupernodalView view = s.factor.supernodes();
    std::size_t widest = 0;
    const auto width = [&](std::size_t n) { return view.first_column[n + 1] - view.first_column[n]; };
    for (std::size_t n = 0; n < view.supernode_count(); ++n)
        if (width(n) > width(widest)) widest = n;
    ASSERT_GE(width(widest), 6);
    std::vector<std::int64_t> wanted;
    std::vector<PanelLoad> entries;
    for (std::int64_t column = view.first_column[widest]; column < view.first_column[widest + 1]; ++column) {
        wanted.push_back(view.permutation[static_cast<std::size_t>(column)]);
        entries.push_back({wanted.back(), column % 2, 1.0 + static_cast<double>(column % 5)});
    }
    expect_dense_solution(s, wanted, entries, 2);
}

TEST(PanelSolver, finds_all_rows_of_a_load_on_every_row) {
    const PanelSetting s;
    std::vector<std::int64_t> wanted;
    std::vector<PanelLoad> entries;
    for (std::int64_t row = 0; row < s.size(); ++row) {
        wanted.push_back(s.size() - 1 - row);
        entries.push_back({row, row, 1.0});
    }
    expect_dense_solution(s, wanted, entries, s.size());
}

TEST(PanelSolver, adds_up_the_entries_of_a_load_and_leaves_empty_ones_zero) {
    const PanelSetting s;
    const std::vector<std::int64_t> wanted{1, 40};
    const PanelSolver solver(s.factor, wanted);
    const std::vector<PanelLoad> twice{{7, 0, 1.0}, {7, 0, 2.0}}, once{{7, 0, 3.0}};
    const MatrixXd found = solver.solve(twice, 2);
    EXPECT_EQ(MatrixXd(found.row(0)), MatrixXd(solver.solve(once, 2).row(0)));
    EXPECT_TRUE(found.row(1).isZero(0));
}

}  // namespace
}  // namespace palpate
