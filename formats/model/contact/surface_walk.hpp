// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "formats/model/triangle_mesh.hpp"

namespace palpate {

/// The vertices that each vertex of a surface shares an edge with, ascending.
struct SurfaceEdges {
    explicit SurfaceEdges(const TriangleMesh& mesh);

    std::span<const std::int32_t> of(std::size_t v) const {
        return std::span(to).subspan(first[v], first[v + 1] - first[v]);
    }

    std::vector<std::size_t> first;
    std::vector<std::int32_t> to;
};

/// The vertices that a walk along a surface's edges reaches within a ball about the first, which comes first.
/// Keeps a view of the surface. Not thread-safe: one for each thread.
class SurfaceWalk {
  public:
    explicit SurfaceWalk(const TriangleMesh& mesh)
        : mesh_(mesh), edges_(mesh), seen_(mesh.vertices.size(), 0) {}

    /// Of those that `takes`; radius in mm. Valid until the next walk.
    template <typename Take>
    const std::vector<std::int32_t>& within(std::int32_t from, double radius, const Take& takes) {
        ++walk_;
        found_.assign(1, from);
        seen_[static_cast<std::size_t>(from)] = walk_;
        const Eigen::Vector3d centre = mesh_.vertices[static_cast<std::size_t>(from)];
        for (std::size_t next = 0; next < found_.size(); ++next)
            for (const std::int32_t v : edges_.of(static_cast<std::size_t>(found_[next]))) {
                std::int32_t& seen = seen_[static_cast<std::size_t>(v)];
                if (seen == walk_ ||
                    (mesh_.vertices[static_cast<std::size_t>(v)] - centre).norm() >= radius || !takes(v))
                    continue;
                seen = walk_;
                found_.push_back(v);
            }
        return found_;
    }
    const std::vector<std::int32_t>& within(std::int32_t from, double radius) {
        return within(from, radius, [](std::int32_t) { return true; });
    }

  private:
    const TriangleMesh& mesh_;
    SurfaceEdges edges_;
    std::vector<std::int32_t> seen_, found_;
    std::int32_t walk_ = 0;
};

/// Of each vertex: a third of the area of its triangles, mm², and their mean normal, unit.
struct VertexShapes {
    std::vector<double> areas;
    std::vector<Eigen::Vector3d> normals;
};
VertexShapes vertex_shapes(const TriangleMesh& mesh);

}  // namespace palpate
