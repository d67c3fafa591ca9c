// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "formats/model/triangle_mesh.hpp"
#include "runtime/collision/triangle_queries.hpp"

namespace palpate::collision {

/// How a triangle lies in its surface. Edge i runs from corner i to the next; whatever several triangles
/// share belongs to one of them.
struct TriangleFeatures {
    std::array<std::int32_t, 3> vertices{};  ///< of the mesh
    /// The corner across each edge, of the triangle beyond it; -1 at a border.
    std::array<std::int32_t, 3> across{-1, -1, -1};
    std::array<std::int32_t, 3> beyond{-1, -1, -1};  ///< the triangle across each edge; -1 at a border
    std::uint8_t own_vertices = 0;                   ///< bit i: corner i belongs to this triangle
    std::uint8_t own_edges = 0;                      ///< bit i: edge i belongs to it
    std::uint8_t own_sharp_edges = 0;                ///< bit i: and is convex or a border
};

/// The faces, edges and vertices of a surface, and to which of them a point or an edge outside can be locally
/// nearest: those in whose normal cone it lies (Johnson, Cohen 2001, "Spatialized normal cone hierarchies").
/// A flat or concave edge need not be asked against edges: its faces or vertices are as near. Vertices are
/// rounded to float32 as in CollisionSurface. All queries are noexcept and realtime-safe.
class SurfaceFeatures {
  public:
    /// `triangles` name vertices of `vertices` (mm, unchecked), in the order in which they are asked for. An
    /// edge of more than two triangles, or of two that run the same way, counts as a border of each. O(n log
    /// n).
    SurfaceFeatures(std::span<const Eigen::Vector3d> vertices, std::span<const Triangle> triangles);

    std::size_t triangle_count() const noexcept { return features_.size(); }
    const TriangleFeatures& of(std::size_t triangle) const noexcept { return features_[triangle]; }
    Eigen::Vector3d vertex(std::int32_t index) const noexcept {
        return vertices_[static_cast<std::size_t>(index)].cast<double>();
    }
    TriangleCorners corners(std::size_t triangle) const noexcept;

    /// Tells whether point b inside edge `edge` of a triangle is locally the surface's nearest in direction
    /// d, across the edge: d leads away from both triangles.
    bool is_nearest_on_edge(std::size_t triangle, std::size_t edge, const Eigen::Vector3d& b,
                            const Eigen::Vector3d& d) const noexcept;
    /// Tells whether a vertex is locally the surface's nearest in direction d: d leads away from all its
    /// edges.
    bool is_nearest_at_vertex(std::int32_t vertex, const Eigen::Vector3d& d) const noexcept;
    /// The same for any point of a triangle as a query found it.
    bool is_nearest(std::size_t triangle, const TrianglePoint& found,
                    const Eigen::Vector3d& d) const noexcept;
    /// The same, and of a face only out of it.
    bool is_nearest_outside(std::size_t triangle, const TrianglePoint& found,
                            const Eigen::Vector3d& d) const noexcept {
        return (found.feature != Feature::face || unit_normal(corners(triangle)).dot(d) > 0) &&
               is_nearest(triangle, found, d);
    }

  private:
    std::vector<Eigen::Vector3f> vertices_;  // mm
    std::vector<TriangleFeatures> features_;
    std::vector<std::int32_t> ring_begin_;  // of each vertex, into ring_
    std::vector<std::int32_t> ring_;        // the other ends of its edges
};

/// Whether bit `i` of a triangle's own vertices or edges is set. Realtime-safe.
inline bool has_bit(std::uint8_t bits, std::size_t i) noexcept {
    return (bits >> i & 1U) != 0;
}

/// The corner, or the edge's first corner, that a query's point lies on, by its weights.
inline std::size_t corner_of(const TrianglePoint& found) noexcept {
    Eigen::Index corner = 0;
    found.barycentric.maxCoeff(&corner);
    return static_cast<std::size_t>(corner);
}
inline std::size_t edge_of(const TrianglePoint& found) noexcept {
    Eigen::Index across = 0;
    found.barycentric.minCoeff(&across);
    return (static_cast<std::size_t>(across) + 1) % 3;
}

/// Whether the feature that a query's point lies on belongs to the triangle. Realtime-safe.
inline bool belongs_to(const TriangleFeatures& triangle, const TrianglePoint& found) noexcept {
    if (found.feature == Feature::face) return true;
    return found.feature == Feature::vertex ? has_bit(triangle.own_vertices, corner_of(found))
                                            : has_bit(triangle.own_edges, edge_of(found));
}

}  // namespace palpate::collision
