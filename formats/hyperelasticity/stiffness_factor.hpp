// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "formats/hyperelasticity/hyperelastic_mesh.hpp"
#include "formats/model/body.hpp"

namespace palpate::hyperelasticity {

/// The Cholesky factor of a body's stiffness at rest in single precision, as a preconditioner has it: float
/// halves what a solve has to read, and so does one index for the nine entries between two nodes, which a
/// solve by entries would read beside each. Nodes are eliminated by least degree (Amestoy, Davis, Duff, SIAM
/// J. Matrix Anal. Appl. 17:886-905, 1996). Allocates on construction only; for one thread.
class StiffnessFactor {
  public:
    /// `mesh` is the body's. Throws InvalidInput as HyperelasticMesh does, and where the stiffness has no
    /// factor in single precision.
    StiffnessFactor(const DeformableBody& body, const HyperelasticMesh& mesh);

    /// Writes what `forces` (N) displace tissue at rest by (mm): both of 3 entries a free node, in the order
    /// of HyperelasticMesh::positions().
    void solve(const Eigen::VectorXd& forces, Eigen::VectorXd& displacements) noexcept;

  private:
    void keep(const Eigen::SparseMatrix<float>& lower);

    std::vector<std::int32_t> node_at_;                 // of a place in the order of elimination
    std::vector<Eigen::Matrix3f> inverse_of_diagonal_;  // of a place
    std::vector<std::size_t> first_;  // block below the diagonal of each place, and one past the last
    std::vector<std::int32_t> row_;   // a place, of each block
    std::vector<Eigen::Matrix3f> block_;
    std::vector<Eigen::Vector3f> moved_;  // of a place, while a solve lasts
};

}  // namespace palpate::hyperelasticity
