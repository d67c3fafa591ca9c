// SPDX-License-Identifier: Apache-2.0
#include "runtime/collision/balls/ball_node.hpp"

#include <algorithm>
#include <limits>

namespace palpate::collision {

using Eigen::Vector3d;

namespace {

// What float32 may be off by, upwards: mm, and of a radius.
constexpr double place_rounding = 1e-4, radius_rounding = 1e-6;

struct Box {
    Vector3d low = Vector3d::Constant(std::numeric_limits<double>::infinity()), high = -low;
    void add(const Vector3d& p) {
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
    }
};

}  // namespace

BallNode ball_about(const SurfaceFeatures& surface, std::span<const std::int32_t> triangles) {
    Box box;
    for (const std::int32_t t : triangles)
        for (const Vector3d& corner : surface.corners(static_cast<std::size_t>(t))) box.add(corner);
    const Vector3d centre = (box.low + box.high) / 2;
    double radius = 0;
    for (const std::int32_t t : triangles)
        for (const Vector3d& corner : surface.corners(static_cast<std::size_t>(t)))
            radius = std::max(radius, (corner - centre).norm());
    BallNode node;
    Eigen::Map<Eigen::Vector3f>(node.centre.data()) = centre.cast<float>();
    node.radius = static_cast<float>(radius * (1 + radius_rounding) + place_rounding);
    node.arm = static_cast<float>((centre.norm() + radius) * (1 + radius_rounding) + place_rounding);
    return node;
}

std::pair<std::span<std::int32_t>, std::span<std::int32_t>> halve(std::span<std::int32_t> items,
                                                                  std::span<const Vector3d> places) {
    Box box;
    for (const std::int32_t i : items) box.add(places[static_cast<std::size_t>(i)]);
    Eigen::Index axis = 0;
    (box.high - box.low).maxCoeff(&axis);
    const std::size_t half = items.size() / 2;
    std::ranges::nth_element(
        items, items.begin() + static_cast<std::ptrdiff_t>(half), {},
        [&](std::int32_t i) { return std::pair(places[static_cast<std::size_t>(i)][axis], i); });
    return {items.first(half), items.subspan(half)};
}

std::vector<Vector3d> centroids_of(const SurfaceFeatures& surface) {
    std::vector<Vector3d> centroids;
    centroids.reserve(surface.triangle_count());
    for (std::size_t t = 0; t < surface.triangle_count(); ++t) {
        const TriangleCorners corners = surface.corners(t);
        centroids.emplace_back((corners[0] + corners[1] + corners[2]) / 3);
    }
    return centroids;
}

double longest_arm_of(const SurfaceFeatures& surface) {
    double longest = 0;
    for (std::size_t t = 0; t < surface.triangle_count(); ++t)
        for (const Vector3d& corner : surface.corners(t)) longest = std::max(longest, corner.norm());
    return longest;
}

}  // namespace palpate::collision
