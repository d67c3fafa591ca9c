// SPDX-License-Identifier: Apache-2.0
#include "formats/elasticity/two_levels.hpp"

#include <array>
#include <vector>

#include "formats/elasticity/stiffness.hpp"

namespace palpate::elasticity {
namespace {

// T: row 3p + axis of each free node, column 3q + axis of each free corner.
Eigen::SparseMatrix<double> corners_to_all(const Discretisation& discretisation,
                                           std::span<const std::int32_t> positions,
                                           std::span<const std::int32_t> corner_positions) {
    std::vector<Eigen::Triplet<double>> entries;
    Eigen::Index nodes = 0, corners = 0;
    const auto add = [&](std::int32_t position, std::int32_t corner, double part) {
        if (position < 0 || corner < 0) return;
        for (std::int32_t axis = 0; axis < 3; ++axis)
            entries.emplace_back(3 * position + axis, 3 * corner + axis, part);
    };
    for (std::size_t node = 0; node < corner_positions.size(); ++node) {
        add(positions[node], corner_positions[node], 1);
        if (corner_positions[node] >= 0) ++corners;
    }
    for (std::size_t edge = 0; edge < discretisation.edges.size(); ++edge)
        for (const std::int32_t end : discretisation.edges[edge])
            add(positions[corner_positions.size() + edge], corner_positions[end], 0.5);
    for (const std::int32_t position : positions)
        if (position >= 0) ++nodes;
    Eigen::SparseMatrix<double> to_all(3 * nodes, 3 * corners);
    to_all.setFromTriplets(entries.begin(), entries.end());
    return to_all;
}

}  // namespace

void TwoLevels::add_corners(const DeformableBody& body, const Discretisation& discretisation,
                            std::span<const std::int32_t> positions) {
    const Discretisation linear = discretise(body.mesh, ElementOrder::linear, body.fixed_nodes);
    if (linear.node_count - linear.fixed_nodes.size() > most_factorised_corners) return;
    const auto corner_positions = number_free_nodes(linear.node_count, linear.fixed_nodes);
    const auto corners = std::make_shared<Corners>();
    corners->to_all = corners_to_all(discretisation, positions, corner_positions);
    corners->factor.compute(
        Eigen::SparseMatrix<double>(assemble_stiffness(body.mesh, body.materials, linear, corner_positions)));
    if (corners->factor.info() == Eigen::Success) corners_ = corners;
}

Eigen::VectorXd TwoLevels::solve(const Eigen::VectorXd& residual) const {
    Eigen::VectorXd z = diagonal_.solve(residual);
    if (corners_) z += corners_->to_all * corners_->factor.solve(corners_->to_all.transpose() * residual);
    return z;
}

}  // namespace palpate::elasticity
