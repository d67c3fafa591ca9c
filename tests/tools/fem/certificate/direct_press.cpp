// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/fem/certificate/direct_press.hpp"

#include <Eigen/Cholesky>
#include <algorithm>

#include "formats/elasticity/stiffness.hpp"
#include "tools/fem/solvers/sparse_cholesky.hpp"

namespace palpate::test {

using namespace fem;

DirectContact spread_over(const DeformableBody& body, const haptics::LoadSpread& spread,
                          const DirectContact& contact) {
    DirectContact result{{}, {}, contact.normal, contact.series_compliance, contact.of_tool};
    for (std::size_t i = 0; i < contact.nodes.size(); ++i) {
        const auto at = std::ranges::lower_bound(body.boundary.nodes, contact.nodes[i]);
        for (const auto& [vertex, weight] :
             spread.shares(static_cast<std::int32_t>(at - body.boundary.nodes.begin()))) {
            result.nodes.push_back(body.boundary.nodes[static_cast<std::size_t>(vertex)]);
            result.weights.push_back(contact.weights[i] * static_cast<double>(weight));
        }
    }
    return result;
}

Eigen::MatrixXd direct_compliance(const DeformableBody& body, const std::vector<DirectContact>& contacts,
                                  double coupling_stiffness) {
    const elasticity::Discretisation discretisation = elasticity::discretise(body);
    const auto position =
        elasticity::number_free_nodes(discretisation.node_count, discretisation.fixed_nodes);
    const elasticity::LowerSparse K =
        elasticity::assemble_stiffness(body.mesh, body.materials, discretisation, position);
    Eigen::MatrixXd loads = Eigen::MatrixXd::Zero(K.rows(), static_cast<Eigen::Index>(contacts.size()));
    for (std::size_t k = 0; k < contacts.size(); ++k)
        for (std::size_t i = 0; i < contacts[k].nodes.size(); ++i) {
            const std::int32_t at = position[static_cast<std::size_t>(contacts[k].nodes[i])];
            if (at >= 0)
                loads.block<3, 1>(3 * at, static_cast<Eigen::Index>(k)) +=
                    contacts[k].weights[i] * contacts[k].normal;
        }
    Eigen::MatrixXd A = loads.transpose() * SparseCholesky(K, Elimination::fill_reducing).solve(loads);
    for (std::size_t k = 0; k < contacts.size(); ++k) {
        const auto row = static_cast<Eigen::Index>(k);
        A(row, row) += contacts[k].series_compliance;
        for (std::size_t l = 0; l < contacts.size(); ++l)
            if (contacts[k].of_tool && contacts[l].of_tool)
                A(row, static_cast<Eigen::Index>(l)) +=
                    contacts[k].normal.dot(contacts[l].normal) / coupling_stiffness;
    }
    return A;
}

Eigen::VectorXd direct_forces(const Eigen::MatrixXd& A, const Eigen::VectorXd& delta,
                              const std::vector<bool>& active) {
    std::vector<Eigen::Index> points;
    for (std::size_t k = 0; k < active.size(); ++k)
        if (active[k]) points.push_back(static_cast<Eigen::Index>(k));
    const Eigen::MatrixXd A_active = A(points, points);
    const Eigen::VectorXd delta_active = delta(points);
    const Eigen::VectorXd f_active = A_active.llt().solve(delta_active);
    Eigen::VectorXd f = Eigen::VectorXd::Zero(delta.size());
    f(points) = f_active;
    return f;
}

}  // namespace palpate::test
