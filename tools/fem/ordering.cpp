// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/fem/ordering.hpp"

#include <algorithm>
#include <metis.h>
#include <numeric>

#include "formats/model/errors.hpp"

namespace palpate {
namespace {

struct Graph {
    std::vector<idx_t> offsets, neighbours;
};

// The mesh's edges between nodes with number[node] >= 0, in compressed rows.
Graph node_graph(const TetMesh& mesh, std::span<const std::int32_t> number, std::size_t count) {
    std::vector<std::vector<idx_t>> rows(count);
    for (const Tetrahedron& tet : mesh.tetrahedra)
        for (const std::int32_t a : tet)
            for (const std::int32_t b : tet) {
                const std::int32_t from = number[static_cast<std::size_t>(a)],
                                   to = number[static_cast<std::size_t>(b)];
                if (from >= 0 && to >= 0 && from != to) rows[static_cast<std::size_t>(from)].push_back(to);
            }
    Graph graph;
    graph.offsets.push_back(0);
    for (auto& row : rows) {
        std::ranges::sort(row);
        row.erase(std::unique(row.begin(), row.end()), row.end());
        graph.neighbours.insert(graph.neighbours.end(), row.begin(), row.end());
        graph.offsets.push_back(static_cast<idx_t>(graph.neighbours.size()));
    }
    return graph;
}

std::vector<idx_t> nested_dissection(Graph graph) {
    auto count = static_cast<idx_t>(graph.offsets.size() - 1);
    std::vector<idx_t> permutation(static_cast<std::size_t>(count)),
        position(static_cast<std::size_t>(count));
    std::iota(position.begin(), position.end(), idx_t{0});
    if (graph.neighbours.empty()) return position;
    std::array<idx_t, METIS_NOPTIONS> options{};
    METIS_SetDefaultOptions(options.data());
    options[METIS_OPTION_SEED] = 1;
    const int status = METIS_NodeND(&count, graph.offsets.data(), graph.neighbours.data(), nullptr,
                                    options.data(), permutation.data(), position.data());
    if (status != METIS_OK)
        throw SystemFailure({"METIS", "ordering failed with code " + std::to_string(status), "",
                             "use a coarser mesh or a machine with more memory"});
    return position;
}

}  // namespace

std::vector<std::int32_t> surface_last_ordering(const TetMesh& mesh,
                                                std::span<const std::int32_t> fixed_nodes,
                                                std::span<const std::int32_t> contact_nodes) {
    std::vector<std::int32_t> number(mesh.rest_positions.size(), 0);
    for (const std::int32_t node : fixed_nodes) number[static_cast<std::size_t>(node)] = -1;
    for (const std::int32_t node : contact_nodes) number[static_cast<std::size_t>(node)] = -1;
    std::int32_t interior = 0;
    for (std::int32_t& n : number)
        if (n >= 0) n = interior++;

    const auto position = nested_dissection(node_graph(mesh, number, static_cast<std::size_t>(interior)));
    for (std::int32_t& n : number)
        if (n >= 0) n = position[static_cast<std::size_t>(n)];
    for (std::size_t k = 0; k < contact_nodes.size(); ++k)
        number[static_cast<std::size_t>(contact_nodes[k])] = interior + static_cast<std::int32_t>(k);
    return number;
}

}  // namespace palpate
