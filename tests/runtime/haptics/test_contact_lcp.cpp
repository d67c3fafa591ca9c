// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Cholesky>
#include <gtest/gtest.h>
#include <memory>
#include <random>
#include <vector>

#include "runtime/haptics/contact/contact_lcp.hpp"

namespace palpate {
namespace {

using namespace haptics;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Tries every active set: the complementary solution is unique for a positive definite A.
VectorXd enumerated(const MatrixXd& A, const VectorXd& delta) {
    for (unsigned set = 0; set < 1U << A.rows(); ++set) {
        std::vector<Index> active;
        for (Index i = 0; i < A.rows(); ++i)
            if (set >> i & 1U) active.push_back(i);
        VectorXd f = VectorXd::Zero(A.rows());
        if (!active.empty()) {
            const VectorXd own = MatrixXd(A(active, active)).llt().solve(VectorXd(delta(active)));
            f(active) = own;
        }
        const VectorXd w = A * f - delta;
        bool good = f.minCoeff() >= 0;
        for (Index i = 0; i < A.rows(); ++i) good = good && ((set >> i & 1U) || w[i] >= -1e-12);
        if (good) return f;
    }
    return VectorXd::Constant(A.rows(), std::nan(""));
}

struct RandomProblem {
    MatrixXd A;
    VectorXd delta;
    RandomProblem(Index n, std::mt19937& generator) {
        std::normal_distribution<double> normal;
        const MatrixXd B = MatrixXd::NullaryExpr(n, n, [&] { return normal(generator); });
        A = B * B.transpose() + 0.05 * MatrixXd::Identity(n, n);
        delta = VectorXd::NullaryExpr(n, [&] { return normal(generator); });
    }
};

void fill(ContactLcp& lcp, const MatrixXd& A, const VectorXd& delta) {
    lcp.matrix().topLeftCorner(A.rows(), A.rows()) = A;
    lcp.gaps().head(A.rows()) = delta;
}

TEST(ContactLcp, finds_the_active_set_that_enumeration_finds) {
    std::mt19937 generator(5);
    const auto lcp = std::make_unique<ContactLcp>();
    for (int i = 0; i < 2000; ++i) {
        const RandomProblem problem(1 + i % 8, generator);
        fill(*lcp, problem.A, problem.delta);
        std::vector<std::size_t> warm;  // right, wrong and empty guesses
        for (Index row = 0; row < problem.A.rows(); ++row)
            if (i % 3 != 0 && generator() % 2) warm.push_back(static_cast<std::size_t>(row));
        const double residual = lcp->solve(static_cast<std::size_t>(problem.A.rows()), warm);
        EXPECT_LE(residual, 1e-8) << i;
        const VectorXd expected = enumerated(problem.A, problem.delta);
        ASSERT_LE((lcp->forces().head(problem.A.rows()) - expected).norm(), 1e-7 * (1 + expected.norm()))
            << i;
    }
}

TEST(ContactLcp, is_complementary_at_full_size) {
    std::mt19937 generator(6);
    const auto lcp = std::make_unique<ContactLcp>();
    for (int i = 0; i < 50; ++i) {
        const Index n = max_contacts;
        const RandomProblem problem(n, generator);
        fill(*lcp, problem.A, problem.delta);
        EXPECT_LE(lcp->solve(max_contacts, {}), 1e-7);
        const VectorXd f = lcp->forces().head(n), w = problem.A * f - problem.delta;
        EXPECT_GE(f.minCoeff(), 0);
        EXPECT_GE(w.minCoeff(), -1e-7);
        EXPECT_LE(f.cwiseProduct(w).cwiseAbs().maxCoeff(), 1e-6);
    }
}

TEST(ContactLcp, two_points_at_one_place_share_no_contradiction) {
    ContactLcp lcp;
    const MatrixXd A = MatrixXd::Constant(2, 2, 3.0);
    for (const double second : {1.0, 1.5, 0.5}) {
        const VectorXd delta = Eigen::Vector2d(1.0, second);
        fill(lcp, A, delta);
        EXPECT_LE(lcp.solve(2, {}), 1e-9);
        EXPECT_NEAR(lcp.forces().head(2).sum(), std::max(1.0, second) / 3, 1e-12);
    }
}

TEST(ContactLcp, the_deeper_of_two_points_at_one_place_takes_over_from_a_warm_start) {
    ContactLcp lcp;
    fill(lcp, MatrixXd::Constant(2, 2, 3.0), Eigen::Vector2d(1.0, 2.0));
    const std::array<std::size_t, 1> shallower{0};
    EXPECT_LE(lcp.solve(2, shallower), 1e-9);
    EXPECT_NEAR(lcp.forces()[1], 2.0 / 3, 1e-12);
    EXPECT_EQ(lcp.forces()[0], 0);
}

TEST(ContactLcp, two_points_that_differ_by_noise_do_not_take_turns) {
    ContactLcp lcp;
    fill(lcp, (MatrixXd(2, 2) << 1, 1 - 4e-6, 1 - 4e-6, 1).finished(), Eigen::Vector2d(1.0, 1.0));
    for (const std::size_t first : {0U, 1U}) {
        const std::array<std::size_t, 1> warm{first};
        EXPECT_LE(lcp.solve(2, warm), 1e-5);
        EXPECT_EQ(lcp.forces()[static_cast<Index>(first)], 1);
    }
}

TEST(ContactLcp, solves_points_of_few_places_from_any_warm_start) {
    // A of low rank, and delta = A g - s of points that some forces g hold: no contradiction.
    std::mt19937 generator(8);
    std::uniform_real_distribution<double> unit(0, 1);
    const auto lcp = std::make_unique<ContactLcp>();
    for (int i = 0; i < 2000; ++i) {
        const Index n = 2 + i % 9, rank = 1 + i % 3;
        MatrixXd normals(n, rank);
        VectorXd held(n), slack(n);
        for (Index row = 0; row < n; ++row) {
            for (Index axis = 0; axis < rank; ++axis) normals(row, axis) = unit(generator) - 0.3;
            held[row] = unit(generator);
            slack[row] = unit(generator);
        }
        const MatrixXd A = normals * normals.transpose();
        fill(*lcp, A, A * held - 0.3 * slack);
        std::vector<std::size_t> warm;
        for (Index row = 0; row < n; ++row)
            if (generator() % 2) warm.push_back(static_cast<std::size_t>(row));
        EXPECT_LE(lcp->solve(static_cast<std::size_t>(n), warm), 1e-6) << i;
        EXPECT_GE(lcp->forces().head(n).minCoeff(), 0) << i;
    }
}

TEST(ContactLcp, nothing_in_contact_gives_no_force) {
    ContactLcp lcp;
    EXPECT_EQ(lcp.solve(0, {}), 0);
    fill(lcp, MatrixXd::Identity(3, 3), Eigen::Vector3d(-1, -2, 0));
    const std::array<std::size_t, 3> all{0, 1, 2};
    EXPECT_LE(lcp.solve(3, all), 1e-9);
    EXPECT_EQ(lcp.forces().head(3).norm(), 0);
}

// Rows that pull as well as press are eliminated; what is left is a problem of the others alone.
TEST(ContactLcp, rows_that_pull_too_are_solved_with_the_others) {
    std::mt19937 generator(11);
    const auto lcp = std::make_unique<ContactLcp>();
    for (int i = 0; i < 500; ++i) {
        const Index n = 1 + i % 6, m = 1 + i % 5;
        const RandomProblem problem(n + m, generator);
        const MatrixXd &A = problem.A, B = A.topRightCorner(n, m), C = A.bottomRightCorner(m, m);
        const VectorXd of_tangents = C.llt().solve(VectorXd(problem.delta.tail(m)));
        const VectorXd expected = enumerated(A.topLeftCorner(n, n) - B * C.llt().solve(B.transpose()),
                                             problem.delta.head(n) - B * of_tangents);
        const VectorXd tangents = C.llt().solve(problem.delta.tail(m) - B.transpose() * expected);
        fill(*lcp, A, problem.delta);
        lcp->solve(static_cast<std::size_t>(n), {});
        const double residual =
            lcp->solve_with(static_cast<std::size_t>(n), static_cast<std::size_t>(m), [](std::size_t) {});
        EXPECT_LT(residual, 1e-8);
        EXPECT_LT((lcp->forces().head(n) - expected).norm(), 1e-8 * (1 + expected.norm()));
        EXPECT_LT((lcp->forces().segment(n, m) - tangents).norm(), 1e-8 * (1 + tangents.norm()));
    }
}

}  // namespace
}  // namespace palpate
