// SPDX-License-Identifier: Apache-2.0
#include "runtime/haptics/contact/triangle_neighbours.hpp"

#include <algorithm>

namespace palpate::haptics {

// Edges lie in a row by the vertex that they leave, those of a vertex by triangle: few to look through, and
// no sort.
std::vector<std::array<std::int32_t, 3>> triangle_neighbours(const std::vector<Triangle>& triangles) {
    struct Edge {
        std::int32_t to, triangle;
    };
    std::int32_t vertex_count = 0;
    for (const Triangle& t : triangles)
        vertex_count = std::max(vertex_count, 1 + *std::ranges::max_element(t));
    std::vector<std::size_t> first(static_cast<std::size_t>(vertex_count) + 1, 0);
    for (const Triangle& t : triangles)
        for (const std::int32_t vertex : t) ++first[vertex + 1];
    for (std::size_t v = 1; v < first.size(); ++v) first[v] += first[v - 1];

    std::vector<Edge> edges(3 * triangles.size());
    std::vector<std::size_t> next(first.begin(), first.end() - 1);
    for (std::size_t t = 0; t < triangles.size(); ++t)
        for (std::size_t corner = 0; corner < 3; ++corner)
            edges[next[triangles[t][corner]]++] = {triangles[t][(corner + 1) % 3],
                                                   static_cast<std::int32_t>(t)};

    std::vector<std::array<std::int32_t, 3>> neighbours(triangles.size());
    for (std::size_t t = 0; t < triangles.size(); ++t)
        for (std::size_t corner = 0; corner < 3; ++corner) {
            const std::int32_t from = triangles[t][corner], to = triangles[t][(corner + 1) % 3];
            const auto begin = edges.begin() + static_cast<std::ptrdiff_t>(first[to]);
            const auto end = edges.begin() + static_cast<std::ptrdiff_t>(first[to + 1]);
            const auto across = std::find_if(begin, end, [&](const Edge& edge) { return edge.to == from; });
            neighbours[t][corner] = across != end ? across->triangle : static_cast<std::int32_t>(t);
        }
    return neighbours;
}

}  // namespace palpate::haptics
