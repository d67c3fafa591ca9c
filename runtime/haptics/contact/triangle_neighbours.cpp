// SPDX-License-Identifier: Apache-2.0
#include "runtime/haptics/contact/triangle_neighbours.hpp"

#include <algorithm>
#include <tuple>

namespace palpate::haptics {

std::vector<std::array<std::int32_t, 3>> triangle_neighbours(const std::vector<Triangle>& triangles) {
    struct Edge {
        std::int32_t from, to, triangle;
        auto operator<=>(const Edge&) const = default;
    };
    std::vector<Edge> edges;
    edges.reserve(3 * triangles.size());
    const auto edge = [&](std::size_t t, std::size_t corner) {
        return Edge{triangles[t][corner], triangles[t][(corner + 1) % 3], static_cast<std::int32_t>(t)};
    };
    for (std::size_t t = 0; t < triangles.size(); ++t)
        for (std::size_t corner = 0; corner < 3; ++corner) edges.push_back(edge(t, corner));
    std::ranges::sort(edges);
    std::vector<std::array<std::int32_t, 3>> neighbours(triangles.size());
    for (std::size_t t = 0; t < triangles.size(); ++t)
        for (std::size_t corner = 0; corner < 3; ++corner) {
            const Edge here = edge(t, corner);
            const auto across = std::ranges::lower_bound(edges, Edge{here.to, here.from, 0});
            const bool found =
                across != edges.end() && std::tie(across->from, across->to) == std::tie(here.to, here.from);
            neighbours[t][corner] = found ? across->triangle : here.triangle;
        }
    return neighbours;
}

}  // namespace palpate::haptics
