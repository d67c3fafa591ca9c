// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/meshing/surfaces/joined_vertices.hpp"

#include <algorithm>
#include <array>
#include <numeric>
#include <vector>

namespace palpate::meshing {

TriangleMesh joined_vertices(const TriangleMesh& surface) {
    const auto coordinates = [&](std::int32_t v) {
        const Eigen::Vector3d& p = surface.vertices[static_cast<std::size_t>(v)];
        return std::array{p.x(), p.y(), p.z()};
    };
    std::vector<std::int32_t> order(surface.vertices.size()), first(surface.vertices.size());
    std::iota(order.begin(), order.end(), 0);
    std::ranges::stable_sort(order, {}, coordinates);
    for (std::size_t i = 0; i < order.size(); ++i) {
        const bool same = i > 0 && coordinates(order[i]) == coordinates(order[i - 1]);
        first[order[i]] = same ? first[order[i - 1]] : order[i];
    }
    TriangleMesh result = surface;
    for (Triangle& t : result.triangles)
        for (std::int32_t& v : t) v = first[v];
    return result;
}

}  // namespace palpate::meshing
