// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/region_surface.hpp"

#include <algorithm>
#include <map>

namespace palpate::visual {

BoundarySurface region_surface(const TetMesh& mesh, std::int32_t region) {
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
    BoundarySurface found;
    for (const auto& [key, face] : open) found.nodes.insert(found.nodes.end(), face.begin(), face.end());
    std::ranges::sort(found.nodes);
    found.nodes.erase(std::ranges::unique(found.nodes).begin(), found.nodes.end());
    for (const std::int32_t node : found.nodes) found.surface.vertices.push_back(mesh.rest_positions[node]);
    for (const auto& [key, face] : open) {
        Triangle triangle;
        for (std::size_t i = 0; i < face.size(); ++i)
            triangle[i] = static_cast<std::int32_t>(std::ranges::lower_bound(found.nodes, face[i]) -
                                                    found.nodes.begin());
        found.surface.triangles.push_back(triangle);
    }
    return found;
}

}  // namespace palpate::visual
