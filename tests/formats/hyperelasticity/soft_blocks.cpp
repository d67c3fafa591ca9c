// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/formats/hyperelasticity/soft_blocks.hpp"

#include <vector>

#include "tests/tools/fem/blocks.hpp"

namespace palpate::test {

DeformableBody soft_block(std::array<int, 3> cells, ElementOrder order, const Material& material) {
    DeformableBody body = held_block(cells, 5 * Eigen::Vector3d(cells[0], cells[1], cells[2]), material);
    jitter_interior(body.mesh, 0.75, 1);
    body.element_order = order;
    return body;
}

DeformableBody unheld_block(std::array<int, 3> cells, ElementOrder order) {
    DeformableBody body = soft_block(cells, order);
    body.fixed_nodes.clear();
    return body;
}

std::vector<std::int32_t> top_patch(const TetMesh& mesh, double radius) {
    Eigen::Vector3d most = mesh.rest_positions.front();
    for (const Eigen::Vector3d& p : mesh.rest_positions) most = most.cwiseMax(p);
    return nodes_where(mesh, [&](const Eigen::Vector3d& p) {
        return p.z() > most.z() - 1e-9 && (p - most / 2).head<2>().norm() < radius;
    });
}

Eigen::VectorXd shared_force(const hyperelasticity::HyperelasticMesh& mesh,
                             std::span<const std::int32_t> nodes, const Eigen::Vector3d& force) {
    Eigen::VectorXd loads = Eigen::VectorXd::Zero(mesh.dofs());
    for (const std::int32_t node : nodes)
        loads.segment<3>(3 * Eigen::Index{mesh.positions().at(static_cast<std::size_t>(node))}) =
            force / static_cast<double>(nodes.size());
    return loads;
}

Eigen::VectorXd of_free_nodes(const hyperelasticity::HyperelasticMesh& mesh, const Eigen::VectorXd& all) {
    Eigen::VectorXd free(mesh.dofs());
    for (std::size_t node = 0; node < mesh.positions().size(); ++node)
        if (mesh.positions()[node] >= 0)
            free.segment<3>(3 * Eigen::Index{mesh.positions()[node]}) =
                all.segment<3>(static_cast<Eigen::Index>(3 * node));
    return free;
}

Eigen::VectorXd of_all_nodes(const hyperelasticity::HyperelasticMesh& mesh, const Eigen::VectorXd& free) {
    Eigen::VectorXd all = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(3 * mesh.positions().size()));
    for (std::size_t node = 0; node < mesh.positions().size(); ++node)
        if (mesh.positions()[node] >= 0)
            all.segment<3>(static_cast<Eigen::Index>(3 * node)) =
                free.segment<3>(3 * Eigen::Index{mesh.positions()[node]});
    return all;
}

}  // namespace palpate::test
