// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "formats/elasticity/discretisation.hpp"

namespace palpate::fem {

/// Orders free nodes for condensation: interior nodes by METIS nested dissection of the interior's own graph
/// and a postorder of its elimination tree, contact nodes last in the given order. Middle nodes of edges
/// count as interior wherever they lie. Returns each node's position, -1 for fixed nodes; contact node k is
/// at position (number of interior nodes) + k. Deterministic. Source: Karypis & Kumar 1998 (METIS_NodeND);
/// Liu 1986.
std::vector<std::int32_t> surface_last_ordering(const elasticity::Discretisation& discretisation,
                                                std::span<const std::int32_t> contact_nodes);

}  // namespace palpate::fem
