// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <array>
#include <functional>
#include <span>
#include <vector>

#include "formats/model/body.hpp"

namespace palpate::test {

/// A box of cells³ cubes, six tetrahedra each (Kuhn), from the origin to `size` mm, one region of value 1.
TetMesh block_mesh(std::array<int, 3> cells, const Eigen::Vector3d& size);

/// The unit cube of MacNeal & Harder's solid patch test: nodes 0 ... 7 its corners, 8 ... 15 the published
/// inner nodes, seven hexahedra cut into six tetrahedra each. Source: Finite Elem. Anal. Des. 1 (1985), 3-20.
TetMesh macneal_harder_cube();

/// Moves interior nodes by up to `amount` mm, seeded.
void jitter_interior(TetMesh& mesh, double amount, unsigned seed);

/// A block held at z = 0, ready to be condensed.
DeformableBody held_block(std::array<int, 3> cells, const Eigen::Vector3d& size, const Material& material);

/// Ascending nodes whose rest position satisfies `condition`.
std::vector<std::int32_t> nodes_where(const TetMesh& mesh,
                                      const std::function<bool(const Eigen::Vector3d&)>& condition);

/// Rest positions of all nodes of discretise(body), middles of edges included, mm.
std::vector<Eigen::Vector3d> node_positions(const DeformableBody& body);

/// The nodes of discretise(body) on the outer boundary, ascending.
std::vector<std::int32_t> boundary_nodes(const DeformableBody& body);

/// A displacement field at all nodes of discretise(body), 3 per node.
Eigen::VectorXd sampled(const DeformableBody& body,
                        const std::function<Eigen::Vector3d(const Eigen::Vector3d&)>& field);

/// Displacements (3 per node of discretise(body)) under prescribed values on `held` nodes and nodal forces
/// elsewhere, by a dense solve of the whole system: the oracle that the sparse and condensed paths are held
/// against.
Eigen::VectorXd solve_dense(const DeformableBody& body, std::span<const std::int32_t> held,
                            const Eigen::VectorXd& prescribed, const Eigen::VectorXd& forces);

/// The full stiffness, dense, all n nodes of discretise(body) free, 3n x 3n.
Eigen::MatrixXd full_stiffness(const DeformableBody& body);

}  // namespace palpate::test
