// SPDX-License-Identifier: GPL-3.0-or-later
// Blocks of soft tissue, and forces on some of their nodes.
#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>

#include "formats/hyperelasticity/hyperelastic_mesh.hpp"
#include "formats/model/body.hpp"

namespace palpate::test {

/// Liver, as the block of tests/benchmarks/large_deformation.py has it.
inline constexpr Material liver_tissue{.youngs_modulus = 6.3e-3, .poissons_ratio = 0.45};

constexpr std::array both_element_orders{ElementOrder::linear, ElementOrder::quadratic};

/// A block of cubes of 5 mm, its inner nodes moved by up to 0.75 mm, held at its bottom.
DeformableBody soft_block(std::array<int, 3> cells, ElementOrder order,
                          const Material& material = liver_tissue);

/// A soft_block() that nothing holds.
DeformableBody unheld_block(std::array<int, 3> cells, ElementOrder order);

/// Mesh nodes on top of a block within `radius` mm of the middle, ascending.
std::vector<std::int32_t> top_patch(const TetMesh& mesh, double radius);

/// `force` (N) in equal parts on `nodes`: 3 entries a free node of the mesh.
Eigen::VectorXd shared_force(const hyperelasticity::HyperelasticMesh& mesh,
                             std::span<const std::int32_t> nodes, const Eigen::Vector3d& force);

/// Of 3 entries a node, those of the free ones, in the order of positions().
Eigen::VectorXd of_free_nodes(const hyperelasticity::HyperelasticMesh& mesh, const Eigen::VectorXd& all);
/// The reverse; zero for fixed nodes.
Eigen::VectorXd of_all_nodes(const hyperelasticity::HyperelasticMesh& mesh, const Eigen::VectorXd& free);

}  // namespace palpate::test
