// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/fem/ordering.hpp"

#include <algorithm>
#include <metis.h>
#include <numeric>

#include "formats/model/errors.hpp"

namespace palpate {
namespace {

struct MetisGraph {
    std::vector<idx_t> offsets, neighbours;
};

// METIS wants no node to be its own neighbour.
MetisGraph without_loops(const NodeGraph& graph) {
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

std::vector<idx_t> nested_dissection(MetisGraph graph) {
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

std::vector<std::int32_t> surface_last_ordering(const Discretisation& discretisation,
                                                std::span<const std::int32_t> contact_nodes) {
    std::vector<std::int32_t> number(discretisation.node_count, 0);
    for (const std::int32_t node : discretisation.fixed_nodes) number[static_cast<std::size_t>(node)] = -1;
    for (const std::int32_t node : contact_nodes) number[static_cast<std::size_t>(node)] = -1;
    std::int32_t interior = 0;
    for (std::int32_t& n : number)
        if (n >= 0) n = interior++;

    const auto position = nested_dissection(without_loops(node_graph(discretisation, number)));
    for (std::int32_t& n : number)
        if (n >= 0) n = position[static_cast<std::size_t>(n)];
    for (std::size_t k = 0; k < contact_nodes.size(); ++k)
        number[static_cast<std::size_t>(contact_nodes[k])] = interior + static_cast<std::int32_t>(k);
    return number;
}

}  // namespace palpate
