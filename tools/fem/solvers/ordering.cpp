// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/fem/solvers/ordering.hpp"

#include <algorithm>
#include <metis.h>
#include <numeric>
#include <utility>

#include "formats/model/errors.hpp"

namespace palpate::fem {
namespace {

struct MetisGraph {
    std::vector<idx_t> offsets, neighbours;
};

// METIS wants no node to be its own neighbour.
MetisGraph without_loops(const elasticity::NodeGraph& graph) {
    MetisGraph result;
    result.offsets.reserve(graph.offsets.size());
    result.neighbours.reserve(graph.neighbours.size());
    result.offsets.push_back(0);
    for (std::size_t p = 0; p + 1 < graph.offsets.size(); ++p) {
        for (auto i = static_cast<std::size_t>(graph.offsets[p]);
             i < static_cast<std::size_t>(graph.offsets[p + 1]); ++i)
            if (graph.neighbours[i] != static_cast<std::int32_t>(p))
                result.neighbours.push_back(graph.neighbours[i]);
        result.offsets.push_back(static_cast<idx_t>(result.neighbours.size()));
    }
    return result;
}

std::vector<idx_t> nested_dissection(MetisGraph& graph) {
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

// The parent of each position in the elimination tree (Liu 1986), -1 for a root; `node_at` and `position` are
// the order and its inverse.
std::vector<idx_t> elimination_tree(const MetisGraph& graph, const std::vector<idx_t>& position,
                                    const std::vector<idx_t>& node_at) {
    std::vector<idx_t> parent(position.size(), -1), ancestor(position.size(), -1);
    for (std::size_t p = 0; p < position.size(); ++p) {
        const auto node = static_cast<std::size_t>(node_at[p]);
        for (auto i = static_cast<std::size_t>(graph.offsets[node]);
             i < static_cast<std::size_t>(graph.offsets[node + 1]); ++i) {
            idx_t below = position[graph.neighbours[i]];
            while (below >= 0 && below < static_cast<idx_t>(p)) {
                const idx_t next = std::exchange(ancestor[below], static_cast<idx_t>(p));
                if (next < 0) parent[below] = static_cast<idx_t>(p);
                below = next;
            }
        }
    }
    return parent;
}

// Renumbers so that what is eliminated together lies together: each subtree of the elimination tree has
// consecutive positions. The factor stays the same, its supernodes grow.
std::vector<idx_t> postordered(const MetisGraph& graph, std::vector<idx_t> position) {
    std::vector<idx_t> node_at(position.size());
    for (std::size_t node = 0; node < position.size(); ++node)
        node_at[position[node]] = static_cast<idx_t>(node);
    const std::vector<idx_t> parent = elimination_tree(graph, position, node_at);
    // Positions are given out from the last on: a parent before its children, so that it ends up after them.
    std::vector<std::vector<idx_t>> children(position.size());
    std::vector<idx_t> waiting;
    for (std::size_t p = 0; p < parent.size(); ++p)
        (parent[p] < 0 ? waiting : children[parent[p]]).push_back(static_cast<idx_t>(p));
    auto next = static_cast<idx_t>(position.size());
    while (!waiting.empty()) {
        const auto p = static_cast<std::size_t>(waiting.back());
        waiting.pop_back();
        position[node_at[p]] = --next;
        waiting.insert(waiting.end(), children[p].begin(), children[p].end());
    }
    return position;
}

}  // namespace

std::vector<std::int32_t> surface_last_ordering(const elasticity::Discretisation& discretisation,
                                                std::span<const std::int32_t> contact_nodes) {
    std::vector<std::int32_t> number(discretisation.node_count, 0);
    for (const std::int32_t node : discretisation.fixed_nodes) number[node] = -1;
    for (const std::int32_t node : contact_nodes) number[node] = -1;
    std::int32_t interior = 0;
    for (std::int32_t& n : number)
        if (n >= 0) n = interior++;

    MetisGraph graph = without_loops(elasticity::node_graph(discretisation, number));
    const auto position = postordered(graph, nested_dissection(graph));
    for (std::int32_t& n : number)
        if (n >= 0) n = position[n];
    for (std::size_t k = 0; k < contact_nodes.size(); ++k)
        number[contact_nodes[k]] = interior + static_cast<std::int32_t>(k);
    return number;
}

}  // namespace palpate::fem
