// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <numeric>
#include <random>

#include "formats/model/compliance.hpp"
#include "tools/fem/condensation/cluster_order.hpp"

namespace palpate {
namespace {

using namespace fem;

std::vector<Eigen::Vector3d> random_points(std::size_t count, const Eigen::Vector3d& size) {
    std::mt19937_64 random(4);
    std::uniform_real_distribution<double> uniform;
    std::vector<Eigen::Vector3d> points;
    for (std::size_t i = 0; i < count; ++i) {
        const double x = uniform(random), y = uniform(random), z = uniform(random);
        points.push_back(size.cwiseProduct(Eigen::Vector3d(x, y, z)));
    }
    return points;
}

TEST(ClusterOrder, holds_every_point_once) {
    const auto points = random_points(777, {10, 20, 5});
    std::vector<std::int32_t> order = cluster_order(points, cluster_depth(777, 32));
    std::ranges::sort(order);
    std::vector<std::int32_t> all(points.size());
    std::iota(all.begin(), all.end(), 0);
    EXPECT_EQ(order, all);
}

// Points of a cube, halved across the longest side three times in turn: every eighth is an octant or nearly
// so.
TEST(ClusterOrder, makes_compact_clusters) {
    const auto points = random_points(4096, {1, 1, 1});
    constexpr std::int32_t depth = 6;
    HierarchicalCompliance clusters;
    clusters.node_count = 4096;
    const auto order = cluster_order(points, depth);
    for (std::int32_t level = 0; level <= depth; ++level)
        for (std::int32_t cluster = 0; cluster < 1 << level; ++cluster) {
            Eigen::AlignedBox3d box;
            for (std::int32_t p = clusters.begin(level, cluster); p < clusters.begin(level, cluster + 1); ++p)
                box.extend(points[static_cast<std::size_t>(order[static_cast<std::size_t>(p)])]);
            // Boxes of 2^-level of the volume; medians of random points stray from the middle.
            EXPECT_LT(box.volume(), 1.3 * std::pow(0.5, level))
                << "cluster " << cluster << " of level " << level;
            EXPECT_LT(box.sizes().maxCoeff(), 2.6 * box.sizes().minCoeff());
        }
}

TEST(ClusterOrder, cuts_a_long_body_across) {
    const auto points = random_points(64, {1, 1, 100});
    const auto order = cluster_order(points, 1);
    const auto z = [&](std::int32_t node) { return points[static_cast<std::size_t>(node)].z(); };
    EXPECT_LT(
        z(*std::max_element(order.begin(), order.begin() + 32, [&](auto a, auto b) { return z(a) < z(b); })),
        z(*std::min_element(order.begin() + 32, order.end(), [&](auto a, auto b) { return z(a) < z(b); })));
}

TEST(ClusterOrder, is_the_same_on_every_run_even_for_points_that_coincide) {
    auto points = random_points(500, {1, 1, 1});
    for (Eigen::Vector3d& point : points) point = (4 * point).array().round() / 4;  // 125 places
    EXPECT_EQ(cluster_order(points, 5), cluster_order(points, 5));
}

TEST(ClusterOrder, of_depth_zero_keeps_the_points_as_they_are) {
    EXPECT_EQ(cluster_order(random_points(5, {1, 1, 1}), 0), (std::vector<std::int32_t>{0, 1, 2, 3, 4}));
}

TEST(ClusterDepth, is_the_least_that_keeps_leaves_small_enough) {
    EXPECT_EQ(cluster_depth(1, 32), 0);
    EXPECT_EQ(cluster_depth(32, 32), 0);
    EXPECT_EQ(cluster_depth(33, 32), 1);
    EXPECT_EQ(cluster_depth(64, 32), 1);
    EXPECT_EQ(cluster_depth(65, 32), 2);
    for (std::int32_t nodes = 1; nodes < 3000; ++nodes) {
        HierarchicalCompliance clusters;
        clusters.node_count = nodes;
        const std::int32_t depth = cluster_depth(nodes, 32);
        const auto largest = [&](std::int32_t level) {
            std::int32_t size = 0;
            for (std::int32_t c = 0; c < 1 << level; ++c)
                size = std::max(size, clusters.begin(level, c + 1) - clusters.begin(level, c));
            return size;
        };
        ASSERT_LE(largest(depth), 32) << nodes;
        if (depth > 0) {
            ASSERT_GT(largest(depth - 1), 32) << nodes;
        }
    }
}

}  // namespace
}  // namespace palpate
