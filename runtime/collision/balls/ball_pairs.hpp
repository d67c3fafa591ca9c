// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>

#include "runtime/collision/balls/ball_node.hpp"
#include "runtime/collision/tree_pairs.hpp"
#include "runtime/collision/triangle_queries.hpp"

namespace palpate::collision {

/// Whether the balls of two parts, the first as `X_BA` has it, are within so much of each other, mm.
/// Realtime-safe.
bool may_be_near(const BallNode& a, const Eigen::Isometry3d& X_BA, const BallNode& b, double within) noexcept;

/// How far apart their balls are, mm; below zero where they overlap. Realtime-safe.
double least_apart(const BallNode& a, const Eigen::Isometry3d& X_BA, const BallNode& b) noexcept;

/// Two nodes by their indices in two trees.
using NodePair = std::array<std::int32_t, 2>;

/// Calls visit(node of a, node of b) for all pairs of leaves at or below `roots` all of whose nodes above
/// `may_be`, a function of two nodes; ends early, and returns false, where `visit` does. A tree has
/// node(index), and no path in it is longer than 32. Realtime-safe where both are.
template <typename TreeA, typename TreeB, typename MayBe, typename Visit>
bool for_each_pair(const TreeA& a, const TreeB& b, const MayBe& may_be, const Visit& visit,
                   const NodePair& roots = {0, 0}) noexcept {
    constexpr std::size_t deepest = 64;  // of both trees together
    std::array<NodePair, deepest + 2> stack;
    std::size_t pending = 1;
    stack[0] = roots;
    while (pending > 0) {
        const auto [of_a, of_b] = stack[--pending];
        const auto &node_a = a.node(of_a), &node_b = b.node(of_b);
        if (!may_be(node_a, node_b)) continue;
        if (node_a.left < 0 && node_b.left < 0) {
            if (!visit(node_a, node_b)) return false;
            continue;
        }
        const bool into_a = node_b.left < 0 || (node_a.left >= 0 && node_a.radius >= node_b.radius);
        for (const std::int32_t child : {1, 0})
            stack[pending++] =
                into_a ? std::array{node_a.left + child, of_b} : std::array{of_a, node_b.left + child};
    }
    return true;
}

/// The corners of a surface's triangle where `X` has it. Realtime-safe.
inline TriangleCorners placed(const Eigen::Isometry3d& X, const TriangleCorners& of) noexcept {
    return {X * of[0], X * of[1], X * of[2]};
}

/// Whether a triangle of one tree's surface, as `X_BA` has it, meets one of another's. Realtime-safe.
template <typename TreeA, typename TreeB>
bool surfaces_meet(const TreeA& a, const Eigen::Isometry3d& X_BA, const TreeB& b) noexcept {
    return !for_each_pair(
        a, b, [&](const BallNode& mine, const BallNode& its) { return may_be_near(mine, X_BA, its, 0); },
        [&](const BallNode& mine, const BallNode& its) {
            const TriangleCorners corners =
                placed(X_BA, a.features().corners(static_cast<std::size_t>(mine.triangle)));
            const TrianglePair pair = closest_points_of_triangles(
                corners, b.features().corners(static_cast<std::size_t>(its.triangle)));
            return pair.on_a.squared_distance > 0;
        });
}

}  // namespace palpate::collision
