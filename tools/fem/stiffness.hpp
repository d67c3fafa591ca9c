// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/SparseCore>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "formats/model/body.hpp"

namespace palpate {

/// Sparse symmetric matrix by its lower triangle, 64-bit indices.
using LowerSparse = Eigen::SparseMatrix<double, Eigen::ColMajor, std::int64_t>;

/// Stiffness of one linear tetrahedron (constant strain), 12 x 12, N/mm, degrees of freedom x, y, z of node
/// 0, ... K_ab = V (lambda g_a g_bᵀ + mu g_b g_aᵀ + mu (g_a . g_b) I) with g the shape function gradients.
/// Annihilates rigid motions. Source: Zienkiewicz & Taylor, The Finite Element Method, linear tetrahedron.
Eigen::Matrix<double, 12, 12> tetrahedron_stiffness(const std::array<Eigen::Vector3d, 4>& points,
                                                    const Material& material);

/// Assembles the stiffness of all nodes with position_of_node[node] >= 0, at rows 3 * position ...; the
/// others are held and drop out. Positions must be 0 ... n-1, each once. Result: lower triangle, 3n x 3n,
/// N/mm. Throws InvalidInput for a tetrahedron of no or negative volume, a modulus <= 0, a Poisson's ratio
/// outside
/// (-1, 0.5) or a region without material.
LowerSparse assemble_stiffness(const TetMesh& mesh, std::span<const RegionMaterial> materials,
                               std::span<const std::int32_t> position_of_node);

/// Numbers the nodes that are not fixed 0 ... n-1 in their order; fixed nodes get -1.
std::vector<std::int32_t> number_free_nodes(std::size_t node_count,
                                            std::span<const std::int32_t> fixed_nodes);

}  // namespace palpate
