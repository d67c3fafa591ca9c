// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/fem/solvers/free_system.hpp"

#include <algorithm>
#include <fmt/format.h>

#include "formats/elasticity/discretisation.hpp"
#include "formats/model/errors.hpp"
#include "tools/fem/solvers/ordering.hpp"

namespace palpate::fem {
namespace {

std::string name_of(const DeformableBody& body, const FreeSystem& system, std::int64_t row) {
    const auto found = std::ranges::find(system.position_of_node, static_cast<std::int32_t>(row / 3));
    const auto node = static_cast<std::size_t>(found - system.position_of_node.begin());
    const auto& positions = body.mesh.rest_positions;
    if (node >= positions.size()) {
        const auto [a, b] = elasticity::discretise(body).edges[node - positions.size()];
        return fmt::format("the middle of nodes {} and {}", a, b);
    }
    const Eigen::Vector3d& p = positions[node];
    return fmt::format("node {} at ({:.1f}, {:.1f}, {:.1f}) mm", node, p.x(), p.y(), p.z());
}

}  // namespace

FreeSystem assemble_free_system(const DeformableBody& body, NodeOrder order) {
    const elasticity::Discretisation discretisation = elasticity::discretise(body);
    FreeSystem system;
    if (order == NodeOrder::as_numbered)
        system.position_of_node =
            elasticity::number_free_nodes(discretisation.node_count, discretisation.fixed_nodes);
    else
        system.position_of_node = surface_last_ordering(discretisation, order == NodeOrder::surface_last
                                                                            ? body.contact_nodes
                                                                            : std::vector<std::int32_t>{});
    system.stiffness =
        elasticity::assemble_stiffness(body.mesh, body.materials, discretisation, system.position_of_node);
    for (const std::int32_t node : body.contact_nodes)
        for (std::int64_t axis = 0; axis < 3; ++axis)
            system.contact_rows.push_back(3 * std::int64_t{system.position_of_node[node]} + axis);
    return system;
}

SparseCholesky factorise(const DeformableBody& body, const FreeSystem& system, Elimination elimination) {
    try {
        return {system.stiffness, elimination};
    } catch (const NotPositiveDefinite& failure) {
        throw InvalidInput(
            {body.name, "its stiffness is not positive definite at " + name_of(body, system, failure.row), "",
             "hold more nodes, or mesh again: a tetrahedron there may be degenerate, or a material "
             "far stiffer than its neighbours"});
    }
}

}  // namespace palpate::fem
