// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "runtime/collision/features/surface_features.hpp"

namespace palpate::collision {

/// A part of a surface in a binary tree: a ball about its triangles. In float32, rounded up.
struct BallNode {
    std::array<float, 3> centre{0, 0, 0};  ///< mm
    float radius = 0;                      ///< mm
    float arm = 0;                         ///< mm: no point of it is farther from the origin
    std::int32_t left = -1;                ///< its first child, the second follows; -1: a triangle
    std::int32_t triangle = -1;            ///< of a leaf
};

/// The ball about the box of some of a surface's triangles, its children and triangle left as none.
BallNode ball_about(const SurfaceFeatures& surface, std::span<const std::int32_t> triangles);

/// Reorders items, named by where they are in `places` (mm), so that the first half of them lies on one side
/// of the second along the longest axis of their box; returns the halves, of equal count or the second one
/// more. Linear on average.
std::pair<std::span<std::int32_t>, std::span<std::int32_t>> halve(std::span<std::int32_t> items,
                                                                  std::span<const Eigen::Vector3d> places);

/// The centroid of every triangle of a surface, mm.
std::vector<Eigen::Vector3d> centroids_of(const SurfaceFeatures& surface);

/// The farthest that any vertex of a surface is from the origin, mm.
double longest_arm_of(const SurfaceFeatures& surface);

}  // namespace palpate::collision
