// SPDX-License-Identifier: Apache-2.0
#include "formats/model/contact/surface_walk.hpp"

#include <Eigen/Geometry>
#include <algorithm>

namespace palpate {
using Eigen::Vector3d;

SurfaceEdges::SurfaceEdges(const TriangleMesh& mesh) {
    std::vector<std::vector<std::int32_t>> lists(mesh.vertices.size());
    for (const Triangle& t : mesh.triangles)
        for (std::size_t corner = 0; corner < 3; ++corner) {
            lists[static_cast<std::size_t>(t[corner])].push_back(t[(corner + 1) % 3]);
            lists[static_cast<std::size_t>(t[corner])].push_back(t[(corner + 2) % 3]);
        }
    first.push_back(0);
    for (auto& list : lists) {
        std::ranges::sort(list);
        list.erase(std::unique(list.begin(), list.end()), list.end());
        to.insert(to.end(), list.begin(), list.end());
        first.push_back(to.size());
    }
}

VertexShapes vertex_shapes(const TriangleMesh& mesh) {
    VertexShapes shapes{std::vector<double>(mesh.vertices.size(), 0),
                        std::vector<Vector3d>(mesh.vertices.size(), Vector3d::Zero())};
    for (const Triangle& t : mesh.triangles) {
        const auto at = [&](std::size_t corner) {
            return mesh.vertices[static_cast<std::size_t>(t[corner])];
        };
        const Vector3d third = (at(1) - at(0)).cross(at(2) - at(0)) / 6;
        for (const std::int32_t v : t) {
            shapes.areas[static_cast<std::size_t>(v)] += third.norm();
            shapes.normals[static_cast<std::size_t>(v)] += third;
        }
    }
    for (Vector3d& normal : shapes.normals) normal.normalize();
    return shapes;
}

}  // namespace palpate
