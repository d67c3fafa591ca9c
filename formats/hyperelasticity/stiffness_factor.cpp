// SPDX-License-Identifier: Apache-2.0
#include "formats/hyperelasticity/stiffness_factor.hpp"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>

#include "formats/elasticity/discretisation.hpp"
#include "formats/elasticity/stiffness.hpp"
#include "formats/model/errors.hpp"

namespace palpate::hyperelasticity {
namespace {

using Eigen::Index;
using SparseMatrix = Eigen::SparseMatrix<float>;

// Free nodes, by their positions, as they are eliminated.
std::vector<std::int32_t> least_degree_order(const HyperelasticMesh& mesh) {
    const elasticity::NodeGraph graph = elasticity::node_graph(mesh.discretisation(), mesh.positions());
    const auto count = static_cast<Index>(graph.offsets.size()) - 1;
    SparseMatrix linked(count, count);
    linked.resizeNonZeros(static_cast<Index>(graph.neighbours.size()));
    std::ranges::copy(graph.offsets, linked.outerIndexPtr());
    std::ranges::copy(graph.neighbours, linked.innerIndexPtr());
    linked.coeffs().setOnes();
    Eigen::PermutationMatrix<Eigen::Dynamic> order;
    Eigen::AMDOrdering<int>()(linked, order);
    return {order.indices().begin(), order.indices().end()};
}

}  // namespace

StiffnessFactor::StiffnessFactor(const DeformableBody& body, const HyperelasticMesh& mesh)
    : node_at_(least_degree_order(mesh)), moved_(node_at_.size()) {
    std::vector<std::int32_t> place_of(node_at_.size());
    for (std::size_t place = 0; place < node_at_.size(); ++place)
        place_of[static_cast<std::size_t>(node_at_[place])] = static_cast<std::int32_t>(place);
    std::vector<std::int32_t> places = mesh.positions();
    for (std::int32_t& place : places)
        if (place >= 0) place = place_of[static_cast<std::size_t>(place)];
    const Eigen::SimplicialLLT<SparseMatrix, Eigen::Lower, Eigen::NaturalOrdering<int>> factor(
        SparseMatrix(elasticity::assemble_stiffness(body.mesh, body.materials, mesh.discretisation(), places)
                         .cast<float>()));
    if (factor.info() != Eigen::Success)
        throw InvalidInput({body.name, "its stiffness is not positive definite in single precision", "",
                            "hold more nodes, or take Poisson's ratio further from 0.5"});
    keep(factor.matrixL().nestedExpression());
}

// A node's three columns have the same rows below its own, three of each node there.
void StiffnessFactor::keep(const SparseMatrix& lower) {
    const auto nodes = static_cast<Index>(node_at_.size());
    inverse_of_diagonal_.reserve(node_at_.size());
    first_.reserve(node_at_.size() + 1);
    const auto blocks = static_cast<std::size_t>(lower.nonZeros() / 9);
    row_.reserve(blocks);
    block_.reserve(blocks);
    for (Index place = 0; place < nodes; ++place) {
        std::array<SparseMatrix::InnerIterator, 3> entry{
            {{lower, 3 * place}, {lower, 3 * place + 1}, {lower, 3 * place + 2}}};
        Eigen::Matrix3f diagonal = Eigen::Matrix3f::Zero();
        for (Index column = 0; column < 3; ++column)
            for (Index row = column; row < 3; ++row, ++entry[static_cast<std::size_t>(column)])
                diagonal(row, column) = entry[static_cast<std::size_t>(column)].value();
        inverse_of_diagonal_.push_back(diagonal.inverse());
        first_.push_back(block_.size());
        while (entry[0]) {
            row_.push_back(static_cast<std::int32_t>(entry[0].row() / 3));
            Eigen::Matrix3f& block = block_.emplace_back();
            for (Index column = 0; column < 3; ++column)
                for (Index row = 0; row < 3; ++row, ++entry[static_cast<std::size_t>(column)])
                    block(row, column) = entry[static_cast<std::size_t>(column)].value();
        }
    }
    first_.push_back(block_.size());
}

void StiffnessFactor::solve(const Eigen::VectorXd& forces, Eigen::VectorXd& displacements) noexcept {
    const std::size_t nodes = node_at_.size();
    for (std::size_t place = 0; place < nodes; ++place)
        moved_[place] = forces.segment<3>(3 * Index{node_at_[place]}).cast<float>();
    for (std::size_t place = 0; place < nodes; ++place) {
        const Eigen::Vector3f solved = inverse_of_diagonal_[place] * moved_[place];
        moved_[place] = solved;
        for (std::size_t k = first_[place]; k < first_[place + 1]; ++k)
            moved_[static_cast<std::size_t>(row_[k])] -= block_[k] * solved;
    }
    for (std::size_t place = nodes; place-- > 0;) {
        Eigen::Vector3f rest = moved_[place];
        for (std::size_t k = first_[place]; k < first_[place + 1]; ++k)
            rest -= block_[k].transpose() * moved_[static_cast<std::size_t>(row_[k])];
        moved_[place] = inverse_of_diagonal_[place].transpose() * rest;
    }
    for (std::size_t place = 0; place < nodes; ++place)
        displacements.segment<3>(3 * Index{node_at_[place]}) = moved_[place].cast<double>();
}

}  // namespace palpate::hyperelasticity
