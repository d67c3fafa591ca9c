// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>

#include "formats/model/body.hpp"

namespace palpate::sample {

/// Assembles K of linear tetrahedra (dense, all nodes, N/mm), x, y, z of node 0 first; one isotropic
/// material.
Eigen::MatrixXd dense_stiffness(const TetMesh& mesh, const Material& material);

/// The elastic cube of sample::elastic_cube() with its true compliance: the inverse of dense_stiffness()
/// without the fixed nodes, restricted to the contact nodes. 5 kPa, Poisson's ratio 0.45.
DeformableBody true_elastic_cube(int cells);

/// Two of them as one body, the other `offset` mm aside: they may lie over each other.
DeformableBody true_elastic_cubes(int cells, const Eigen::Vector3d& offset);

/// The first, its top bent to a cylinder of `radius` (mm) about an axis along y under the middle of the top.
DeformableBody true_elastic_arch(int cells, double radius);

/// The same body with these contact nodes alone (some of the body's own, ascending), and their rows and
/// columns of its compliance.
DeformableBody with_contact_nodes(DeformableBody body, const std::vector<std::int32_t>& contact_nodes);

/// The material of true_elastic_cube().
Material soft_tissue();

}  // namespace palpate::sample
