// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <atomic>
#include <cstring>
#include <gtest/gtest.h>

#include "tests/tools/fem/compliances.hpp"
#include "tools/fem/condensation/compress.hpp"

namespace palpate {
namespace {

using namespace fem;
using Eigen::Index;
using Eigen::MatrixXd;

// A known compliance and where its nodes are.
struct Known {
    MatrixXd C;
    std::vector<Eigen::Vector3d> points;
    mutable std::atomic<std::size_t> most_rows{0};  // nodes asked for at once

    Known() {
        const DeformableBody body = test::large_block();
        C = test::full(condense_by_solves(body, 2, test::no_progress));
        for (const std::int32_t node : body.contact_nodes)
            points.push_back(body.mesh.rest_positions[static_cast<std::size_t>(node)]);
    }

    HierarchicalCompliance compressed(double accuracy, int threads) const {
        const ComplianceRows rows = [this](std::span<const std::int32_t> nodes) {
            for (std::size_t most = most_rows;
                 most < nodes.size() && !most_rows.compare_exchange_weak(most, nodes.size());) {
            }
            return MatrixXd(C(test::dofs_of({nodes.begin(), nodes.end()}), Eigen::all));
        };
        return compress(points, rows, accuracy, threads, test::no_progress);
    }
};

const Known& known() {
    static const Known one;
    return one;
}

TEST(Compression, keeps_every_row_and_column_within_its_accuracy) {
    ASSERT_GE(known().points.size(), 600U);
    for (const double accuracy : {1e-2, 1e-3}) {
        const MatrixXd stored = test::entries_of(known().compressed(accuracy, 2));
        const MatrixXd error = stored - known().C;
        EXPECT_LT((error.rowwise().norm().array() / known().C.rowwise().norm().array()).maxCoeff(), accuracy);
        EXPECT_LT((error.colwise().norm().array() / known().C.colwise().norm().array()).maxCoeff(), accuracy);
    }
}

// 16-bit factors keep about 2e-5 of a block's largest entries, which for a row of small ones is more; what is
// asked for beyond that is put beside them. The floor is that of sums in float32.
TEST(Compression, is_as_accurate_as_is_asked_beyond_its_factors_integers) {
    constexpr double accuracy = 1e-6, sums = 2e-6;
    const MatrixXd error = test::entries_of(known().compressed(accuracy, 2)) - known().C;
    EXPECT_LT(error.norm(), sums * known().C.norm());
    EXPECT_LT((error.rowwise().norm().array() / known().C.rowwise().norm().array()).maxCoeff(),
              accuracy + sums);
}

// Two soft tips in clusters of their own answer to each other more than to anything else, and a block's other
// entries are small beside that one.
TEST(Compression, keeps_the_small_entries_of_a_soft_node) {
    constexpr double accuracy = 1e-3;
    MatrixXd C = known().C;
    const std::vector<std::int32_t> order = known().compressed(accuracy, 2).order;
    const Index a = 3 * Index{order.front()}, b = 3 * Index{order[order.size() / 3]};
    const double soft = 300 * C.cwiseAbs().maxCoeff();
    C.block<3, 3>(a, a).diagonal().array() += 2 * soft;
    C.block<3, 3>(b, b).diagonal().array() += 2 * soft;
    C.block<3, 3>(a, b).diagonal().array() += soft;
    C.block<3, 3>(b, a).diagonal().array() += soft;
    const ComplianceRows rows = [&](std::span<const std::int32_t> nodes) {
        return MatrixXd(C(test::dofs_of({nodes.begin(), nodes.end()}), Eigen::all));
    };
    MatrixXd error = test::entries_of(compress(known().points, rows, accuracy, 2, test::no_progress)) - C;
    // Against what the rows were before.
    EXPECT_LT((error.rowwise().norm().array() / known().C.rowwise().norm().array()).maxCoeff(), accuracy);
}

TEST(Compression, takes_less_than_a_dense_compliance_and_ever_less_for_less_accuracy) {
    const double dense = 4 * static_cast<double>(known().C.size());
    std::size_t finer = static_cast<std::size_t>(0.9 * dense);
    for (const double accuracy : {1e-4, 1e-3, 1e-2}) {
        const std::size_t bytes = value_bytes(known().compressed(accuracy, 2));
        EXPECT_LT(bytes, finer) << "at " << accuracy;
        finer = bytes;
    }
    EXPECT_LT(static_cast<double>(finer), dense / 4);
}

// As a node whose neighbours are all held: it answers to its own force alone.
TEST(Compression, keeps_a_node_behind_held_ones) {
    MatrixXd C = known().C;
    constexpr Index node = 7;
    const Eigen::Matrix3d own = C.block<3, 3>(3 * node, 3 * node);
    C.middleRows<3>(3 * node).setZero();
    C.middleCols<3>(3 * node).setZero();
    C.block<3, 3>(3 * node, 3 * node) = own;
    const ComplianceRows rows = [&](std::span<const std::int32_t> nodes) {
        return MatrixXd(C(test::dofs_of({nodes.begin(), nodes.end()}), Eigen::all));
    };
    const MatrixXd error = test::entries_of(compress(known().points, rows, 1e-3, 2, test::no_progress)) - C;
    EXPECT_LT((error.rowwise().norm().array() / C.rowwise().norm().array()).maxCoeff(), 1e-3);
}

TEST(Compression, is_symmetric) {
    const MatrixXd stored = test::entries_of(known().compressed(1e-3, 1));
    // Single products of float32 factors; the sum's order does not depend on the side.
    EXPECT_LT((stored - stored.transpose()).cwiseAbs().maxCoeff(), 1e-6 * stored.cwiseAbs().maxCoeff());
}

TEST(Compression, gives_the_same_bytes_at_any_number_of_threads) {
    const HierarchicalCompliance one = known().compressed(1e-3, 1);
    for (const int threads : {2, 3}) {
        const HierarchicalCompliance more = known().compressed(1e-3, threads);
        EXPECT_EQ(more.order, one.order);
        ASSERT_EQ(more.blocks.size(), one.blocks.size());
        for (std::size_t b = 0; b < one.blocks.size(); ++b) {
            EXPECT_EQ(more.blocks[b].first_child, one.blocks[b].first_child);
            EXPECT_EQ(more.blocks[b].rank, one.blocks[b].rank);
            EXPECT_EQ(more.blocks[b].values, one.blocks[b].values);
            EXPECT_EQ(more.blocks[b].factors, one.blocks[b].factors);
        }
        ASSERT_EQ(more.value_count, one.value_count);
        ASSERT_EQ(more.factor_count, one.factor_count);
        EXPECT_EQ(std::memcmp(more.values.get(), one.values.get(), sizeof(float) * one.value_count), 0);
        EXPECT_EQ(std::memcmp(more.factors.get(), one.factors.get(), sizeof(std::int16_t) * one.factor_count),
                  0);
    }
}

TEST(Compression, never_asks_for_many_rows_at_once) {
    constexpr std::size_t sample = 64, cluster = 32;  // nodes whose rows give the scales, and of a leaf
    known().most_rows = 0;
    known().compressed(1e-3, 2);
    EXPECT_LE(known().most_rows, std::max(sample, cluster));
    EXPECT_GT(known().most_rows, 0U);
}

TEST(Compression, of_fewer_nodes_than_a_cluster_holds_is_one_dense_block) {
    const DeformableBody body = test::lumpy_block();
    const MatrixXd C = test::full(condense_by_solves(body, 1, test::no_progress));
    const auto few = test::dofs_of({0, 1, 2, 3, 4});
    const MatrixXd part = C(few, few);
    std::vector<Eigen::Vector3d> points;
    for (std::size_t k = 0; k < 5; ++k)
        points.push_back(body.mesh.rest_positions[static_cast<std::size_t>(body.contact_nodes[k])]);
    const ComplianceRows rows = [&](std::span<const std::int32_t> nodes) {
        return MatrixXd(part(test::dofs_of({nodes.begin(), nodes.end()}), Eigen::all));
    };
    const HierarchicalCompliance stored = compress(points, rows, 1e-3, 1, test::no_progress);
    ASSERT_EQ(stored.blocks.size(), 1U);
    EXPECT_EQ(stored.blocks[0].rank, ComplianceBlock::dense);
    EXPECT_LT((test::entries_of(stored) - part).cwiseAbs().maxCoeff(),
              1e-6 * part.cwiseAbs().maxCoeff());  // float32
}

}  // namespace
}  // namespace palpate
