// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "runtime/collision/triangle_queries.hpp"

namespace palpate::collision {

/// The points of two segments that are nearest to each other.
struct SegmentPair {
    double s = 0, t = 0;                              ///< fractions of the first and the second, 0 ... 1
    Eigen::Vector3d first = Eigen::Vector3d::Zero();  ///< mm
    Eigen::Vector3d second = Eigen::Vector3d::Zero();
    double squared_distance = 0;  ///< mm²
};

/// Finds the nearest points of segments a0-a1 and b0-b1 (mm), either of which may be a point (Ericson,
/// Real-Time Collision Detection, 2005, 5.1.9, with s from cross products, which lose no digits where the
/// two are nearly parallel). Realtime-safe.
SegmentPair closest_points_of_segments(const Eigen::Vector3d& a0, const Eigen::Vector3d& a1,
                                       const Eigen::Vector3d& b0, const Eigen::Vector3d& b1) noexcept;

/// The points of a segment and a triangle that are nearest to each other.
struct SegmentTrianglePair {
    double fraction = 0;                                      ///< of the segment, 0 ... 1
    Eigen::Vector3d segment_point = Eigen::Vector3d::Zero();  ///< mm
    TrianglePoint foot;                                       ///< the triangle's point
};

/// Finds where segment a-b goes through the inside of triangle `t` (mm); nullopt if it does not or the
/// triangle has no area. Realtime-safe.
std::optional<SegmentTrianglePair> pierce(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                          const TriangleCorners& t) noexcept;

}  // namespace palpate::collision
