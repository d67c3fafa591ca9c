// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <memory>
#include <numeric>
#include <random>
#include <vector>

#include "formats/model/compliance.hpp"
#include "tests/formats/sample_case.hpp"

namespace palpate {
namespace {

using Eigen::Vector3f;

constexpr double epsilon = std::numeric_limits<float>::epsilon();
constexpr double exact = 1e-12;  // accuracy that keeps every singular value of a random matrix

DenseCompliance dense_of(const Eigen::MatrixXf& matrix) {
    const std::shared_ptr<float[]> entries(new float[static_cast<std::size_t>(matrix.size())]);
    Eigen::Map<Eigen::MatrixXf>(entries.get(), matrix.rows(), matrix.cols()) = matrix;  // symmetric
    return {static_cast<std::int32_t>(matrix.rows() / 3),
            std::shared_ptr<const float>(entries, entries.get())};
}

// Symmetric, each entry another number, so that no two can be mistaken for each other; diagonal positive.
DenseCompliance random_compliance(std::int32_t nodes, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> entry(-1, 1);
    Eigen::MatrixXf matrix(3 * nodes, 3 * nodes);
    for (Eigen::Index i = 0; i < matrix.rows(); ++i)
        for (Eigen::Index j = 0; j <= i; ++j)
            matrix(i, j) = matrix(j, i) = entry(random) + (i == j ? 2.0F : 0.0F);
    return dense_of(matrix);
}

std::vector<std::int32_t> shuffled(std::int32_t nodes, unsigned seed) {
    std::vector<std::int32_t> order(static_cast<std::size_t>(nodes));
    std::iota(order.begin(), order.end(), 0);
    std::shuffle(order.begin(), order.end(), std::mt19937(seed));
    return order;
}

// What rounding does to an entry at most. A factor is wrong by half a unit and at most 32767 units large, and
// there are two, so that term k is wrong by 32767 s_k; the float32 sum adds its round-off.
double rounding(const HierarchicalCompliance& c) {
    constexpr double largest = 32767;
    double worst = 0;
    for (const ComplianceBlock& block : c.blocks) {
        if (block.first_child > 0 || block.rank == ComplianceBlock::dense) continue;
        double sum = 0;
        for (std::int32_t k = 0; k < block.rank; ++k)
            sum += std::abs(static_cast<double>(c.values.get()[block.values + k])) * largest *
                   (1 + (block.rank + 3) * epsilon * largest);
        worst = std::max(worst, sum);
    }
    return worst;
}

double largest_difference(const DenseCompliance& dense, const HierarchicalCompliance& blocks) {
    double worst = 0;
    for (std::int32_t a = 0; a < dense.node_count; ++a)
        for (std::int32_t b = 0; b < dense.node_count; ++b)
            worst = std::max(
                worst,
                static_cast<double>(
                    (compliance_block(blocks, a, b) - compliance_block(dense, a, b)).cwiseAbs().maxCoeff()));
    return worst;
}

std::ptrdiff_t count_of_low_rank(const HierarchicalCompliance& c) {
    return std::ranges::count_if(c.blocks,
                                 [](const ComplianceBlock& b) { return b.first_child == 0 && b.rank >= 0; });
}

struct Size {
    std::int32_t nodes, depth;
};

void PrintTo(const Size& size, std::ostream* stream) {
    *stream << size.nodes << " nodes, depth " << size.depth;
}

class BlocksOfEverySize : public ::testing::TestWithParam<Size> {
  protected:
    DenseCompliance dense_ = random_compliance(GetParam().nodes, 1);
    HierarchicalCompliance blocks_ =
        sample::hierarchical(dense_, shuffled(GetParam().nodes, 2), GetParam().depth, exact);
};

// One node; one block; clusters of one node; halves that do not come out even; powers of two.
INSTANTIATE_TEST_SUITE_P(Each, BlocksOfEverySize,
                         ::testing::Values(Size{1, 0}, Size{7, 0}, Size{5, 2}, Size{9, 3}, Size{64, 3},
                                           Size{61, 3}, Size{61, 2}, Size{61, 1}),
                         [](const auto& info) {
                             return std::to_string(info.param.nodes) + "_nodes_depth_" +
                                    std::to_string(info.param.depth);
                         });

TEST_P(BlocksOfEverySize, give_every_3_x_3_block_of_the_dense_matrix) {
    EXPECT_EQ(count_of_low_rank(blocks_) > 0, GetParam().depth >= 2);
    EXPECT_LE(largest_difference(dense_, blocks_), rounding(blocks_));
    EXPECT_LE(rounding(blocks_), 2e-3);  // or the bound would pass anything: entries are of the order of 1
}

TEST_P(BlocksOfEverySize, are_symmetric_bit_for_bit) {
    for (std::int32_t a = 0; a < GetParam().nodes; ++a)
        for (std::int32_t b = 0; b < GetParam().nodes; ++b)
            ASSERT_EQ(compliance_block(blocks_, a, b), compliance_block(blocks_, b, a).transpose())
                << a << " " << b;
}

// Loads on random nodes; those of many loads repeat, and take several rounds of 256.
TEST_P(BlocksOfEverySize, multiply_like_the_dense_matrix) {
    const std::int32_t nodes = GetParam().nodes;
    std::mt19937 random(3);
    std::uniform_int_distribution<std::int32_t> node(0, nodes - 1);
    std::uniform_real_distribution<float> component(-1, 1);
    for (const std::size_t count : {1U, 2U, 20U, 256U, 257U, 700U}) {
        std::vector<NodeForce> forces(count);
        Eigen::VectorXd load = Eigen::VectorXd::Zero(3 * nodes);
        for (NodeForce& f : forces) {
            f = {node(random), {component(random), component(random), component(random)}};
            load.segment<3>(3 * f.node) += f.force.cast<double>();
        }
        const Eigen::MatrixXd matrix =
            Eigen::Map<const Eigen::MatrixXf>(dense_.entries.get(), 3 * nodes, 3 * nodes).cast<double>();
        const Vector3f before(0.5F, -0.25F, 2);  // displacements are added
        const Eigen::VectorXd expected = matrix * load + before.cast<double>().replicate(nodes, 1);

        double absolute = 0;
        for (const NodeForce& f : forces) absolute += static_cast<double>(f.force.lpNorm<1>());
        // Every sum of float32 terms is wrong by at most (terms) epsilon (sum of magnitudes); entries are
        // at most 3.
        const double summation = 3 * static_cast<double>(3 * count + 4) * epsilon * (absolute + 2);
        for (const SurfaceCompliance& c : {SurfaceCompliance(dense_), SurfaceCompliance(blocks_)}) {
            const bool by_blocks = std::holds_alternative<HierarchicalCompliance>(c);
            std::vector<Vector3f> u(static_cast<std::size_t>(nodes), before);
            add_displacements(c, forces, u);
            const Eigen::Map<const Eigen::VectorXf> found(u.front().data(), 3 * nodes);
            EXPECT_LE((found.cast<double>() - expected).cwiseAbs().maxCoeff(),
                      summation + (by_blocks ? rounding(blocks_) * absolute : 0))
                << count << (by_blocks ? " loads, blocks" : " loads, dense");
        }
    }
}

// Against the blocks' own entries no rounding of factors is to be allowed for: a load on one node must give
// what compliance_block() says, and the many-load case adds up.
TEST_P(BlocksOfEverySize, multiply_by_the_entries_that_they_give) {
    const std::int32_t nodes = GetParam().nodes;
    const Vector3f force(0.3F, -1, 0.7F);
    for (std::int32_t loaded = 0; loaded < nodes; ++loaded) {
        const NodeForce one{loaded, force};
        std::vector<Vector3f> u(static_cast<std::size_t>(nodes), Vector3f::Zero());
        add_displacements(blocks_, {&one, 1}, u);
        for (std::int32_t a = 0; a < nodes; ++a) {
            const Vector3f expected = compliance_block(blocks_, a, loaded) * force;
            // float32 round-off of up to 48 terms, whose magnitudes add up to less than 30
            ASSERT_LE((u[static_cast<std::size_t>(a)] - expected).norm(), 48 * epsilon * 30)
                << a << " " << loaded;
        }
    }
}

TEST(HierarchicalCompliance, is_allowed_the_error_that_was_asked_for_and_a_dense_one_that_of_float32) {
    HierarchicalCompliance blocks;
    blocks.accuracy = 1e-3;
    EXPECT_EQ(allowed_error(blocks), 1e-3);
    EXPECT_EQ(allowed_error(DenseCompliance{}), 1e-6);
}

TEST(HierarchicalCompliance, without_loads_displaces_nothing) {
    const HierarchicalCompliance blocks =
        sample::hierarchical(random_compliance(9, 1), shuffled(9, 2), 2, exact);
    std::vector<Vector3f> u(9, Vector3f::Zero());
    add_displacements(blocks, {}, u);
    for (const Vector3f& moved : u) EXPECT_EQ(moved, Vector3f::Zero());
}

TEST(HierarchicalCompliance, leaves_out_what_the_accuracy_lets_it) {
    const DeformableBody body = sample::elastic_cube(5);
    const auto& dense = std::get<DenseCompliance>(body.compliance);
    constexpr double accuracy = 1e-3;  // of the largest entry, 1 mm/N
    const DeformableBody less = sample::with_hierarchical_compliance(body, 3, accuracy);
    const auto& blocks = std::get<HierarchicalCompliance>(less.compliance);
    const double difference = largest_difference(dense, blocks);
    EXPECT_LE(difference, accuracy + rounding(blocks));
    EXPECT_GT(difference, rounding(blocks));  // something was left out
    EXPECT_LT(value_bytes(less.compliance), value_bytes(body.compliance) / 2);
}

TEST(HierarchicalCompliance, may_have_blocks_of_rank_0) {
    constexpr std::int32_t nodes = 21, reach = 3;  // coupled to three neighbours; clusters hold 5 or 6
    const DenseCompliance full = random_compliance(nodes, 4);
    Eigen::MatrixXf matrix = Eigen::Map<const Eigen::MatrixXf>(full.entries.get(), 3 * nodes, 3 * nodes);
    for (Eigen::Index i = 0; i < matrix.rows(); ++i)
        for (Eigen::Index j = 0; j < matrix.cols(); ++j)
            if (std::abs(i / 3 - j / 3) > reach) matrix(i, j) = 0;
    const DenseCompliance dense = dense_of(matrix);
    std::vector<std::int32_t> in_a_row(nodes);
    std::iota(in_a_row.begin(), in_a_row.end(), 0);
    const HierarchicalCompliance blocks = sample::hierarchical(dense, in_a_row, 2, exact);
    EXPECT_EQ(std::ranges::count(blocks.blocks, 0, &ComplianceBlock::rank), 3);
    EXPECT_EQ(largest_difference(dense, blocks), 0);

    const NodeForce end{nodes - 1, {1, 2, 3}};
    std::vector<Vector3f> u(nodes, Vector3f::Zero());
    add_displacements(blocks, {&end, 1}, u);
    for (std::int32_t a = 0; a < nodes; ++a)
        EXPECT_EQ(u[static_cast<std::size_t>(a)].norm() > 0, nodes - 1 - a <= reach) << a;
}

TEST(HierarchicalCompliance, says_how_many_bytes_its_values_take) {
    const DenseCompliance dense = random_compliance(10, 1);
    EXPECT_EQ(value_bytes(dense), 900 * sizeof(float));
    const HierarchicalCompliance blocks = sample::hierarchical(dense, shuffled(10, 1), 2, exact);
    EXPECT_EQ(value_bytes(blocks), 4 * blocks.value_count + 2 * blocks.factor_count);
    EXPECT_EQ(node_count(blocks), 10);
}

}  // namespace
}  // namespace palpate
