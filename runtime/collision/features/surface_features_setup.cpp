// SPDX-License-Identifier: Apache-2.0
// What triangles share, found once.
#include <algorithm>
#include <tuple>

#include "runtime/collision/features/surface_features.hpp"

namespace palpate::collision {
namespace {

using Eigen::Vector3d;

// Sine of the angle by which a convex edge is bent at least: less stands out of its faces by nothing.
constexpr double flat = 1e-4;

struct EdgeUse {
    std::int32_t low, high;
    std::int32_t triangle;
    std::uint8_t edge;
    bool upwards;  // runs from low to high
};

// Whether the corner across lies below the triangle's plane, or the triangle has none.
bool is_convex(const TriangleCorners& t, std::size_t edge, const Vector3d& across) {
    const Vector3d normal = unit_normal(t);
    const Vector3d along = (t[(edge + 1) % 3] - t[edge]).normalized();
    const Vector3d way = across - t[edge];
    const double height = (way - along.dot(way) * along).norm();
    return !(height > 0) || normal.isZero(0) || normal.dot(way) < -flat * height;
}

}  // namespace

SurfaceFeatures::SurfaceFeatures(std::span<const Vector3d> vertices, std::span<const Triangle> triangles)
    : features_(triangles.size()), ring_begin_(vertices.size() + 1) {
    for (const Vector3d& v : vertices) vertices_.push_back(v.cast<float>());
    std::vector<EdgeUse> uses;
    uses.reserve(3 * triangles.size());
    std::vector<bool> owned(vertices.size());
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        TriangleFeatures& features = features_[t];
        features.vertices = triangles[t];
        for (std::size_t i = 0; i < 3; ++i) {
            const std::int32_t from = triangles[t][i], to = triangles[t][(i + 1) % 3];
            uses.push_back({std::min(from, to), std::max(from, to), static_cast<std::int32_t>(t),
                            static_cast<std::uint8_t>(i), from < to});
            if (owned[static_cast<std::size_t>(from)]) continue;
            owned[static_cast<std::size_t>(from)] = true;
            features.own_vertices |= static_cast<std::uint8_t>(1U << i);
        }
    }
    const auto key = [](const EdgeUse& use) { return std::tuple(use.low, use.high, use.triangle, use.edge); };
    std::ranges::sort(uses, {}, key);
    const auto own = [&](const EdgeUse& use, std::uint8_t TriangleFeatures::*bits) {
        features_[static_cast<std::size_t>(use.triangle)].*bits |= static_cast<std::uint8_t>(1U << use.edge);
    };
    const auto corner_across = [&](const EdgeUse& use) {
        return features_[static_cast<std::size_t>(use.triangle)].vertices[(use.edge + 2U) % 3];
    };
    for (auto first = uses.begin(); first != uses.end();) {
        const auto last = std::find_if(first, uses.end(), [&](const EdgeUse& u) {
            return u.low != first->low || u.high != first->high;
        });
        ++ring_begin_[static_cast<std::size_t>(first->low) + 1];
        ++ring_begin_[static_cast<std::size_t>(first->high) + 1];
        if (last - first == 2 && first[0].upwards != first[1].upwards) {
            const std::int32_t across = corner_across(first[1]);
            const auto triangle = static_cast<std::size_t>(first[0].triangle);
            TriangleFeatures &one = features_[triangle],
                             &other = features_[static_cast<std::size_t>(first[1].triangle)];
            one.across[first[0].edge] = across;
            other.across[first[1].edge] = corner_across(first[0]);
            one.beyond[first[0].edge] = first[1].triangle;
            other.beyond[first[1].edge] = first[0].triangle;
            own(first[0], &TriangleFeatures::own_edges);
            if (is_convex(corners(triangle), first[0].edge, vertex(across)))
                own(first[0], &TriangleFeatures::own_sharp_edges);
        } else {
            for (const EdgeUse& use : std::span(first, last)) {
                own(use, &TriangleFeatures::own_edges);
                own(use, &TriangleFeatures::own_sharp_edges);
            }
        }
        first = last;
    }
    for (std::size_t v = 0; v < vertices.size(); ++v) ring_begin_[v + 1] += ring_begin_[v];
    ring_.resize(static_cast<std::size_t>(ring_begin_.back()));
    std::vector<std::int32_t> next(ring_begin_.begin(), ring_begin_.end() - 1);
    for (std::size_t u = 0; u < uses.size(); ++u) {
        const auto [low, high] = std::pair(uses[u].low, uses[u].high);
        if (u > 0 && uses[u - 1].low == low && uses[u - 1].high == high) continue;
        ring_[static_cast<std::size_t>(next[static_cast<std::size_t>(low)]++)] = high;
        ring_[static_cast<std::size_t>(next[static_cast<std::size_t>(high)]++)] = low;
    }
}

}  // namespace palpate::collision
