// SPDX-License-Identifier: Apache-2.0
#include "formats/elasticity/inner_nodes.hpp"

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>

#include "formats/elasticity/discretisation.hpp"
#include "formats/elasticity/stiffness.hpp"
#include "formats/model/errors.hpp"

namespace palpate::elasticity {
namespace {

using Eigen::Index;

// Surface vertices at the ends of each edge of a surface.
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

struct InnerNodes::Factor {
    Eigen::SparseMatrix<double> coupling;  // K_is
    Eigen::SimplicialLLT<Eigen::SparseMatrix<float>> within;
};

InnerNodes::InnerNodes(const DeformableBody& body) : boundary_nodes_(body.boundary.nodes) {
    const Discretisation all = discretise(body.mesh, body.element_order, {});
    std::vector<Edge> edges;
    if (body.element_order == ElementOrder::quadratic) edges = boundary_edges(body.mesh);
    const auto boundary = boundary_of(body.boundary, all, body.mesh.rest_positions.size(), edges);
    for (const Edge& edge : edges)
        boundary_edges_.push_back({vertex_of(edge[0], boundary_nodes_), vertex_of(edge[1], boundary_nodes_)});

    positions_ = number_free_nodes(all.node_count, boundary);
    const auto inner = static_cast<std::int32_t>(all.node_count - boundary.size());
    for (std::size_t i = 0; i < boundary.size(); ++i)
        positions_[boundary[i]] = inner + static_cast<std::int32_t>(i);
    const LowerSparse stiffness = assemble_stiffness(body.mesh, body.materials, all, positions_);
    positions_.resize(body.mesh.rest_positions.size());

    const Index within = 3 * Index{inner}, around = stiffness.rows() - within;
    const auto factor = std::make_shared<Factor>();
    factor->coupling = Eigen::SparseMatrix<double>(stiffness.block(within, 0, around, within)).transpose();
    factor->within.compute(Eigen::SparseMatrix<double>(stiffness.block(0, 0, within, within)).cast<float>());
    if (within > 0 && factor->within.info() != Eigen::Success)
        throw InvalidInput({body.name, "the stiffness within it is not positive definite in single precision",
                            "", "take Poisson's ratio further from 0.5"});
    factor_ = factor;
}

std::vector<Eigen::Vector3f> InnerNodes::follow(std::span<const Eigen::Vector3f> surface) const {
    Eigen::VectorXd imposed(factor_->coupling.cols());
    Index at = 0;
    for (const Eigen::Vector3f& u : surface) imposed.segment<3>(3 * at++) = u.cast<double>();
    for (const Edge& edge : boundary_edges_)
        imposed.segment<3>(3 * at++) = (surface[edge[0]] + surface[edge[1]]).cast<double>() / 2;
    Eigen::VectorXd within;
    if (factor_->coupling.rows() > 0)
        within = factor_->within.solve((-(factor_->coupling * imposed)).cast<float>()).cast<double>();

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
