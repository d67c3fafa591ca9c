// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>

#include "runtime/collision/cones/normal_cone_tree.hpp"

namespace palpate::collision {

/// What two parts must hold to be looked into.
struct ConeReach {
    double within = 0;  ///< mm, between the points of a pair
    double slack = 0;   ///< mm, that the first surface may move meanwhile
    double turn = 0;    ///< rad, that it may turn meanwhile
};

/// Whether two parts, the first as `X_BA` has it, may hold points that are locally nearest to each other:
/// their balls are near enough, and among the directions from one to the other there are some of both cones.
/// Realtime-safe.
bool may_be_nearest(const ConeNode& a, const Eigen::Isometry3d& X_BA, const ConeNode& b,
                    const ConeReach& reach) noexcept;
/// Whether their balls are within so much of each other, mm. Realtime-safe.
bool may_be_near(const ConeNode& a, const Eigen::Isometry3d& X_BA, const ConeNode& b, double within) noexcept;

/// Calls visit(node of a, node of b) for all pairs of leaves all of whose nodes above `may_be`, a
/// function of two nodes; ends early, and returns false, where `visit` does. Realtime-safe where both are.
template <typename MayBe, typename Visit>
bool for_each_pair(const NormalConeTree& a, const NormalConeTree& b, const MayBe& may_be,
                   const Visit& visit) noexcept {
    constexpr std::size_t deepest = 64;  // of both trees together, which are balanced
    std::array<std::array<std::int32_t, 2>, deepest + 2> stack;
    std::size_t pending = 1;
    stack[0] = {0, 0};
    while (pending > 0) {
        const auto [of_a, of_b] = stack[--pending];
        const ConeNode &node_a = a.node(of_a), &node_b = b.node(of_b);
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

}  // namespace palpate::collision
