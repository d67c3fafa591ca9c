// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/benchmarks/condensation/free_stiffness.hpp"

#include "tools/fem/discretisation.hpp"

namespace palpate {

FreeStiffness free_stiffness(const DeformableBody& body) {
    const Discretisation discretisation = discretise(body);
    const auto position = number_free_nodes(discretisation.node_count, discretisation.fixed_nodes);
    FreeStiffness result{assemble_stiffness(body.mesh, body.materials, discretisation, position), {}};
    for (const std::int32_t node : body.contact_nodes)
        for (int axis = 0; axis < 3; ++axis)
            result.surface_rows.push_back(3 * std::int64_t{position[static_cast<std::size_t>(node)]} + axis);
    return result;
}

}  // namespace palpate
