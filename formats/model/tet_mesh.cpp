// SPDX-License-Identifier: Apache-2.0
#include "formats/model/tet_mesh.hpp"

#include <Eigen/Geometry>
#include <algorithm>

namespace palpate {

BoundarySurface boundary_surface(const TetMesh& mesh) {
    struct Face {
        Triangle key;
        std::size_t order;
    };
    std::vector<Face> all;
    all.reserve(mesh.tetrahedra.size() * 4);
    const auto corners = [&](std::size_t order) {
        const Tetrahedron& tet = mesh.tetrahedra[order / 4];
        const auto& face = tetrahedron_faces[order % 4];
        return Triangle{tet[face[0]], tet[face[1]], tet[face[2]]};
    };
    for (std::size_t order = 0; order < mesh.tetrahedra.size() * 4; ++order) {
        Triangle key = corners(order);
        std::ranges::sort(key);
        all.push_back({key, order});
    }
    std::ranges::sort(all, {}, &Face::key);

    std::vector<std::size_t> boundary;
    for (std::size_t i = 0; i < all.size();) {
        std::size_t end = i + 1;
        while (end < all.size() && all[end].key == all[i].key) ++end;
        if (end - i == 1) boundary.push_back(all[i].order);
        i = end;
    }
    std::ranges::sort(boundary);

    BoundarySurface result;
    std::vector<std::int32_t> vertex_of(mesh.rest_positions.size(), -1);
    for (const std::size_t order : boundary)
        for (const std::int32_t node : corners(order)) vertex_of[node] = 0;
    for (std::size_t node = 0; node < vertex_of.size(); ++node) {
        if (vertex_of[node] < 0) continue;
        vertex_of[node] = static_cast<std::int32_t>(result.nodes.size());
        result.nodes.push_back(static_cast<std::int32_t>(node));
        result.surface.vertices.push_back(mesh.rest_positions[node]);
    }
    for (const std::size_t order : boundary) {
        const Triangle t = corners(order);
        result.surface.triangles.push_back({vertex_of[t[0]], vertex_of[t[1]], vertex_of[t[2]]});
    }
    return result;
}

double six_volume(const TetMesh& mesh, std::size_t t) {
    const auto point = [&](std::size_t corner) -> const Eigen::Vector3d& {
        return mesh.rest_positions[mesh.tetrahedra[t][corner]];
    };
    return (point(1) - point(0)).cross(point(2) - point(0)).dot(point(3) - point(0));
}

std::vector<Eigen::Vector3d> surface_normals(const TriangleMesh& surface) {
    std::vector<Eigen::Vector3d> normals(surface.vertices.size(), Eigen::Vector3d::Zero());
    for (const Triangle& triangle : surface.triangles) {
        const auto corner = [&](std::size_t c) -> const Eigen::Vector3d& {
            return surface.vertices[static_cast<std::size_t>(triangle[c])];
        };
        const Eigen::Vector3d twice_area = (corner(1) - corner(0)).cross(corner(2) - corner(0));
        for (const std::int32_t vertex : triangle) normals[static_cast<std::size_t>(vertex)] += twice_area;
    }
    for (Eigen::Vector3d& normal : normals) normal.normalize();
    return normals;
}

}  // namespace palpate
