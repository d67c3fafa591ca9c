// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cstddef>

#include "formats/hyperelasticity/hyperelastic_mesh.hpp"
#include "formats/hyperelasticity/stiffness_factor.hpp"
#include "formats/model/body.hpp"

namespace palpate::hyperelasticity {

/// Where neo-Hookean tissue comes to rest under forces on its nodes: the least of W(u) - f . u, from where
/// the last search ended. Quasi-Newton steps: the factor of the stiffness at rest stands for the tangent, and
/// the last steps correct it (L-BFGS; Matthies, Strang, Int. J. Numer. Meth. Engng 14:1613-1626, 1979;
/// Nocedal, Math. Comp. 35:773-782, 1980); each step must lower the energy (Armijo). The nearer Poisson's
/// ratio is to 0.5, the more steps: some 15 at 0.45, 60 at 0.499; beyond 0.4999 steps become shorter
/// than what is missing. Allocates on construction only; for one thread.
class Equilibrium {
  public:
    /// Assembles and factorises the stiffness: some 0.3 s for 3 500 nodes of linear tetrahedra. Throws
    /// InvalidInput as HyperelasticMesh does, for fewer than 3 fixed nodes, and if the stiffness has no
    /// Cholesky factor in single precision. Unchecked: that each piece of the mesh is held.
    explicit Equilibrium(const DeformableBody& body);

    const HyperelasticMesh& mesh() const noexcept { return mesh_; }
    /// Of 3 entries a free node (HyperelasticMesh::positions()), mm.
    const Eigen::VectorXd& displacements() const noexcept { return displacements_; }

    /// Back to rest; all that was learnt of the tangent is forgotten.
    void reset() noexcept;

    /// Goes on under `loads` (N, as displacements()) until a step would move no node by more than `settled`
    /// (mm), after `most` steps, or where rounding hides what another would win. Returns how far the last
    /// step, taken whole, moves a node, mm: about what is missing still; infinite after no step or for
    /// loads that are no numbers, which change nothing.
    double approach(const Eigen::VectorXd& loads, double settled, int most) noexcept;

  private:
    static constexpr Eigen::Index remembered = 12;  // steps

    void set_direction() noexcept;
    bool descend(const Eigen::VectorXd& loads, double slope) noexcept;

    HyperelasticMesh mesh_;
    double edge_;  // of a tetrahedron, mm
    StiffnessFactor factor_;
    Eigen::VectorXd displacements_, internal_, residual_;  // mm, N, N
    Eigen::VectorXd direction_, tried_, tried_internal_;
    // The last steps (mm), what they changed internal forces by (N), and 1 / (step . change), in a ring.
    Eigen::MatrixXd steps_, changes_;
    Eigen::Matrix<double, remembered, 1> inverse_;
    Eigen::Index known_ = 0, newest_ = 0;
    double energy_ = 0;  // N mm
};

}  // namespace palpate::hyperelasticity
