// SPDX-License-Identifier: Apache-2.0
#include "runtime/collision/features/surface_features.hpp"

namespace palpate::collision {

using Eigen::Vector3d;

namespace {

// What counts as across: the sine of an angle that rounding may make of a right one.
constexpr double right_angle_rounding = 1e-9;

bool leads_away(const Vector3d& d, const Vector3d& to) noexcept {
    return d.dot(to) <= right_angle_rounding * d.norm() * to.norm();
}

}  // namespace

TriangleCorners SurfaceFeatures::corners(std::size_t triangle) const noexcept {
    const auto& v = features_[triangle].vertices;
    return {vertex(v[0]), vertex(v[1]), vertex(v[2])};
}

bool SurfaceFeatures::is_nearest_on_edge(std::size_t triangle, std::size_t edge, const Vector3d& b,
                                         const Vector3d& d) const noexcept {
    const TriangleFeatures& features = features_[triangle];
    if (!leads_away(d, vertex(features.vertices[(edge + 2) % 3]) - b)) return false;
    return features.across[edge] < 0 || leads_away(d, vertex(features.across[edge]) - b);
}

bool SurfaceFeatures::is_nearest_at_vertex(std::int32_t at, const Vector3d& d) const noexcept {
    const Vector3d b = vertex(at);
    const auto index = static_cast<std::size_t>(at);
    for (std::int32_t k = ring_begin_[index]; k < ring_begin_[index + 1]; ++k)
        if (!leads_away(d, vertex(ring_[static_cast<std::size_t>(k)]) - b)) return false;
    return true;
}

bool SurfaceFeatures::is_nearest(std::size_t triangle, const TrianglePoint& found,
                                 const Vector3d& d) const noexcept {
    if (found.feature == Feature::face) return true;
    if (found.feature == Feature::edge) return is_nearest_on_edge(triangle, edge_of(found), found.point, d);
    return is_nearest_at_vertex(features_[triangle].vertices[corner_of(found)], d);
}

}  // namespace palpate::collision
