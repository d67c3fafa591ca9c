// SPDX-License-Identifier: Apache-2.0
#include "formats/elasticity/discretisation.hpp"

#include <algorithm>

#include "formats/elasticity/sound_tetrahedra.hpp"

namespace palpate::elasticity {
namespace {

using Edge = std::array<std::int32_t, 2>;

Edge edge_between(std::int32_t a, std::int32_t b) {
    return {std::min(a, b), std::max(a, b)};
}

void sort_and_thin(std::vector<Edge>& edges) {
    std::ranges::sort(edges);
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
}

std::vector<Edge> edges_of(const TetMesh& mesh) {
    std::vector<Edge> edges;
    edges.reserve(6 * mesh.tetrahedra.size());
    for (const Tetrahedron& tet : mesh.tetrahedra)
        for (const auto& [a, b] : tetrahedron_edges) edges.push_back(edge_between(tet[a], tet[b]));
    sort_and_thin(edges);
    return edges;
}

}  // namespace

std::vector<std::array<std::int32_t, 2>> boundary_edges(const TetMesh& mesh) {
    const BoundarySurface boundary = boundary_surface(mesh);
    std::vector<Edge> edges;
    for (const Triangle& t : boundary.surface.triangles)
        for (std::size_t c = 0; c < 3; ++c)
            edges.push_back(edge_between(boundary.nodes[t[c]], boundary.nodes[t[(c + 1) % 3]]));
    sort_and_thin(edges);
    return edges;
}

Discretisation discretise(const TetMesh& mesh, ElementOrder order,
                          std::span<const std::int32_t> fixed_nodes) {
    require_sound_tetrahedra(mesh);
    Discretisation result;
    result.node_count = mesh.rest_positions.size();
    result.fixed_nodes.assign(fixed_nodes.begin(), fixed_nodes.end());
    if (order == ElementOrder::linear) {
        result.elements.reserve(4 * mesh.tetrahedra.size());
        for (const Tetrahedron& tet : mesh.tetrahedra)
            result.elements.insert(result.elements.end(), tet.begin(), tet.end());
        return result;
    }
    result.nodes_per_element = 10;
    result.edges = edges_of(mesh);
    const auto middle_of = [&](const Edge& edge) {
        const auto rank = std::ranges::lower_bound(result.edges, edge) - result.edges.begin();
        return static_cast<std::int32_t>(mesh.rest_positions.size()) + static_cast<std::int32_t>(rank);
    };
    result.node_count += result.edges.size();
    result.elements.reserve(10 * mesh.tetrahedra.size());
    for (const Tetrahedron& tet : mesh.tetrahedra) {
        result.elements.insert(result.elements.end(), tet.begin(), tet.end());
        for (const auto& [a, b] : tetrahedron_edges)
            result.elements.push_back(middle_of(edge_between(tet[a], tet[b])));
    }
    const auto held = [&](std::int32_t node) { return std::ranges::binary_search(fixed_nodes, node); };
    if (!fixed_nodes.empty())
        for (const Edge& edge : boundary_edges(mesh))
            if (held(edge[0]) && held(edge[1])) result.fixed_nodes.push_back(middle_of(edge));
    return result;
}

Discretisation discretise(const DeformableBody& body) {
    return discretise(body.mesh, body.element_order, body.fixed_nodes);
}

std::span<const std::int32_t> nodes_of_element(const Discretisation& discretisation, std::size_t t) {
    const auto size = static_cast<std::size_t>(discretisation.nodes_per_element);
    return std::span(discretisation.elements).subspan(size * t, size);
}

NodeGraph node_graph(const Discretisation& discretisation, std::span<const std::int32_t> position_of_node) {
    const auto count =
        static_cast<std::size_t>(std::ranges::count_if(position_of_node, [](auto p) { return p >= 0; }));
    const auto per_element = static_cast<std::size_t>(discretisation.nodes_per_element);
    const auto& elements = discretisation.elements;
    const auto position = [&](std::size_t entry) { return position_of_node[elements[entry]]; };

    // The elements around each position, in compressed rows.
    std::vector<std::size_t> first(count + 1, 0);
    for (std::size_t entry = 0; entry < elements.size(); ++entry)
        if (position(entry) >= 0) ++first[static_cast<std::size_t>(position(entry)) + 1];
    for (std::size_t p = 0; p < count; ++p) first[p + 1] += first[p];
    std::vector<std::size_t> around(first[count]), next(first.begin(), first.end() - 1);
    for (std::size_t entry = 0; entry < elements.size(); ++entry)
        if (position(entry) >= 0) around[next[position(entry)]++] = entry / per_element;

    NodeGraph graph;
    graph.offsets.reserve(count + 1);
    graph.offsets.push_back(0);
    std::vector<std::size_t> last_seen_from(count, count);
    for (std::size_t p = 0; p < count; ++p) {
        for (std::size_t i = first[p]; i < first[p + 1]; ++i)
            for (const std::int32_t node : nodes_of_element(discretisation, around[i])) {
                const std::int32_t q = position_of_node[node];
                if (q < 0 || last_seen_from[q] == p) continue;
                last_seen_from[q] = p;
                graph.neighbours.push_back(q);
            }
        std::sort(graph.neighbours.begin() + graph.offsets.back(), graph.neighbours.end());
        graph.offsets.push_back(static_cast<std::int64_t>(graph.neighbours.size()));
    }
    return graph;
}

}  // namespace palpate::elasticity
