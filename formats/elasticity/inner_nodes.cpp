// SPDX-License-Identifier: Apache-2.0
#include "formats/elasticity/inner_nodes.hpp"

#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>
#include <algorithm>

#include "formats/elasticity/discretisation.hpp"
#include "formats/elasticity/stiffness.hpp"

namespace palpate::elasticity {
namespace {

using Eigen::Index;

// The nodes at the ends of an edge.
using Edge = std::array<std::int32_t, 2>;

// Nodes of a surface's vertices, then the middles of its edges.
std::vector<std::int32_t> boundary_of(const BoundarySurface& boundary, const Discretisation& all,
                                      std::size_t mesh_nodes, std::span<const Edge> mesh_edges) {
    std::vector<std::int32_t> nodes = boundary.nodes;
    for (const Edge& edge : mesh_edges)
        nodes.push_back(static_cast<std::int32_t>(
            mesh_nodes + (std::ranges::lower_bound(all.edges, edge) - all.edges.begin())));
    return nodes;
}

std::int32_t vertex_of(std::int32_t node, std::span<const std::int32_t> boundary_nodes) {
    return static_cast<std::int32_t>(std::ranges::lower_bound(boundary_nodes, node) - boundary_nodes.begin());
}

}  // namespace

struct InnerNodes::Within {
    Eigen::SparseMatrix<double> coupling, stiffness;  // K_is, K_ii, of which the lower triangle
    Eigen::ConjugateGradient<Eigen::SparseMatrix<double>, Eigen::Lower> gradients;
    Eigen::VectorXd displacements;  // as found last, from which the next search begins
};

InnerNodes::InnerNodes(const DeformableBody& body) {
    const Discretisation all = discretise(body.mesh, body.element_order, {});
    std::vector<Edge> edges;
    if (body.element_order == ElementOrder::quadratic) edges = boundary_edges(body.mesh);
    const auto boundary = boundary_of(body.boundary, all, body.mesh.rest_positions.size(), edges);
    for (const Edge& edge : edges)
        boundary_edges_.push_back(
            {vertex_of(edge[0], body.boundary.nodes), vertex_of(edge[1], body.boundary.nodes)});

    positions_ = number_free_nodes(all.node_count, boundary);
    const auto inner = static_cast<std::int32_t>(all.node_count - boundary.size());
    for (std::size_t i = 0; i < boundary.size(); ++i)
        positions_[boundary[i]] = inner + static_cast<std::int32_t>(i);
    const LowerSparse stiffness = assemble_stiffness(body.mesh, body.materials, all, positions_);
    positions_.resize(body.mesh.rest_positions.size());

    const Index within = 3 * Index{inner}, around = stiffness.rows() - within;
    constexpr double settled = 1e-6;  // of the forces that the boundary's displacements make
    within_ = std::make_shared<Within>();
    within_->coupling = Eigen::SparseMatrix<double>(stiffness.block(within, 0, around, within)).transpose();
    within_->stiffness = stiffness.block(0, 0, within, within);
    within_->displacements.setZero(within);
    within_->gradients.setTolerance(settled);
    within_->gradients.setMaxIterations(most_steps);
    within_->gradients.compute(within_->stiffness);
}

std::vector<Eigen::Vector3f> InnerNodes::follow(std::span<const Eigen::Vector3f> surface) {
    Eigen::VectorXd imposed(within_->coupling.cols());
    Index at = 0;
    for (const Eigen::Vector3f& u : surface) imposed.segment<3>(3 * at++) = u.cast<double>();
    for (const Edge& edge : boundary_edges_)
        imposed.segment<3>(3 * at++) = (surface[edge[0]] + surface[edge[1]]).cast<double>() / 2;
    Eigen::VectorXd& within = within_->displacements;
    if (within.size() > 0)
        within = within_->gradients.solveWithGuess(Eigen::VectorXd(-(within_->coupling * imposed)), within);

    std::vector<Eigen::Vector3f> displacements(positions_.size());
    for (std::size_t node = 0; node < positions_.size(); ++node) {
        const Index entry = 3 * Index{positions_[node]};
        displacements[node] = (entry < within.size() ? Eigen::Vector3d(within.segment<3>(entry))
                                                     : imposed.segment<3>(entry - within.size()))
                                  .cast<float>();
    }
    return displacements;
}

}  // namespace palpate::elasticity
