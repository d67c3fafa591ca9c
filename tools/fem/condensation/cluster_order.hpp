// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

namespace palpate::fem {

/// Returns how often `node_count` nodes are halved until a cluster has at most `largest_leaf`.
std::int32_t cluster_depth(std::int32_t node_count, std::int32_t largest_leaf);

/// Orders points so that every cluster of a HierarchicalCompliance of this depth is compact: each is halved
/// by number across the longest side of its bounding box. Returns the point at each position. Deterministic.
std::vector<std::int32_t> cluster_order(std::span<const Eigen::Vector3d> points, std::int32_t depth);

}  // namespace palpate::fem
