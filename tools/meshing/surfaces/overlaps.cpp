// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/meshing/surfaces/overlaps.hpp"

#include <cmath>
#include <vector>

#include "formats/model/closure.hpp"
#include "tools/meshing/surfaces/pieces.hpp"
#include "tools/meshing/surfaces/surfaces.hpp"

namespace palpate::meshing {
namespace {

Eigen::Vector3d centre_of(const TriangleMesh& surface, const Triangle& triangle) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const std::int32_t v : triangle) sum += surface.vertices[static_cast<std::size_t>(v)];
    return sum / 3;
}

// Just off the triangle's middle on its outer side.
Eigen::Vector3d outside_of(const TriangleMesh& surface, const Triangle& triangle) {
    constexpr double part_of_size = 1e-4;
    const auto corner = [&](std::size_t c) {
        return surface.vertices[static_cast<std::size_t>(triangle[c])];
    };
    const Eigen::Vector3d twice_area = (corner(1) - corner(0)).cross(corner(2) - corner(0));
    return centre_of(surface, triangle) + part_of_size * twice_area / std::sqrt(twice_area.norm());
}

}  // namespace

std::optional<Eigen::Vector3d> place_of_overlap(const TriangleMesh& boundary) {
    if (const auto cut = first_self_intersection(boundary))
        return centre_of(boundary, boundary.triangles[(*cut)[0]]);
    // No piece cuts another, so that one place of each tells what lies outside all of it: nothing.
    DisjointSets pieces = pieces_of(boundary);
    std::vector<bool> seen(boundary.vertices.size(), false);
    for (const Triangle& triangle : boundary.triangles) {
        const std::size_t piece = pieces.root(static_cast<std::size_t>(triangle[0]));
        if (seen[piece]) continue;
        seen[piece] = true;
        if (std::lround(winding_number(boundary, outside_of(boundary, triangle))) != 0)
            return centre_of(boundary, triangle);
    }
    return {};
}

}  // namespace palpate::meshing
