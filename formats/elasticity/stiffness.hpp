// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/SparseCore>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "formats/elasticity/discretisation.hpp"
#include "formats/model/body.hpp"

namespace palpate::elasticity {

/// Sparse symmetric matrix by its lower triangle, 64-bit indices.
using LowerSparse = Eigen::SparseMatrix<double, Eigen::ColMajor, std::int64_t>;

/// Computes the stiffness of a straight-sided tetrahedron from its corners (mm), N/mm: 12 x 12 for
/// linear, 30 x 30 for quadratic displacements; degrees of freedom x, y, z of node 0, 1, ... with the nodes
/// as in Discretisation::elements. With shape function gradients g,
/// K_ab = integral of lambda g_a g_bᵀ + mu g_b g_aᵀ + mu (g_a . g_b) I over the volume, exact by quadrature:
/// one point for the constant gradients of linear elements, four points (degree 2) for the linear gradients
/// of quadratic ones. Annihilates rigid motions and nothing else. Unchecked: volume and material. Sources:
/// Zienkiewicz & Taylor, The Finite Element Method, vol. 1, tetrahedral elements; Hammer & Stroud 1956
/// (rule of degree 2, also Keast 1986).
Eigen::MatrixXd tetrahedron_stiffness(const std::array<Eigen::Vector3d, 4>& corners, const Material& material,
                                      ElementOrder order);

/// Throws InvalidInput for a modulus <= 0, a Poisson's ratio outside (-1, 0.5), a region with two materials,
/// or one of the mesh without any.
void require_sound_materials(const TetMesh& mesh, std::span<const RegionMaterial> materials);

/// Assembles the stiffness of all nodes with position_of_node[node] >= 0, at rows 3 * position ...; the
/// others are held and drop out. position_of_node has discretisation.node_count entries, and positions must
/// be 0 ... n-1, each once. Result: lower triangle, 3n x 3n, N/mm. Throws InvalidInput as
/// require_sound_materials() does; discretise() has refused bad tetrahedra.
LowerSparse assemble_stiffness(const TetMesh& mesh, std::span<const RegionMaterial> materials,
                               const Discretisation& discretisation,
                               std::span<const std::int32_t> position_of_node);

/// Numbers the nodes that are not fixed 0 ... n-1 in their order; fixed nodes get -1.
std::vector<std::int32_t> number_free_nodes(std::size_t node_count,
                                            std::span<const std::int32_t> fixed_nodes);

}  // namespace palpate::elasticity
