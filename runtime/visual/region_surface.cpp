// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/region_surface.hpp"

#include <algorithm>
#include <map>

namespace palpate::visual {

TriangleMesh region_surface(const TetMesh& mesh, std::int32_t region) {
    std::map<Triangle, Triangle> open;  // sorted corners -> the face
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
        if (mesh.regions[t] != region) continue;
        for (const auto& corners : tetrahedron_faces) {
            Triangle face;
            for (std::size_t i = 0; i < face.size(); ++i) face[i] = mesh.tetrahedra[t][corners[i]];
            Triangle key = face;
            std::ranges::sort(key);
            if (const auto [entry, added] = open.try_emplace(key, face); !added) open.erase(entry);
        }
    }
    TriangleMesh surface;
    std::map<std::int32_t, std::int32_t> vertex_of_node;
    for (const auto& [key, face] : open) {
        Triangle triangle;
        for (std::size_t i = 0; i < face.size(); ++i) {
            const auto [entry, added] =
                vertex_of_node.try_emplace(face[i], static_cast<std::int32_t>(surface.vertices.size()));
            if (added) surface.vertices.push_back(mesh.rest_positions[face[i]]);
            triangle[i] = entry->second;
        }
        surface.triangles.push_back(triangle);
    }
    return surface;
}

}  // namespace palpate::visual
