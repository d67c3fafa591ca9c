// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "formats/elasticity/discretisation.hpp"
#include "formats/elasticity/shape_gradients.hpp"
#include "formats/hyperelasticity/neo_hookean.hpp"
#include "formats/model/body.hpp"

namespace palpate::hyperelasticity {

/// The tetrahedra of a body as neo-Hookean tissue, by its rest (total Lagrangian): energy and nodal forces of
/// any displacement. Displacements and forces are vectors of 3 entries a free node, in the order of
/// positions(); fixed nodes stay where they are.
class HyperelasticMesh {
  public:
    /// Elements of the body's own order. Throws InvalidInput as discretise() and require_sound_materials()
    /// do.
    explicit HyperelasticMesh(const DeformableBody& body);

    const elasticity::Discretisation& discretisation() const noexcept { return discretisation_; }
    /// Of each node of the discretisation: its place among the free ones, -1 if it is fixed.
    const std::vector<std::int32_t>& positions() const noexcept { return positions_; }
    Eigen::Index dofs() const noexcept { return dofs_; }

    /// Writes the forces (N) that hold the tissue in a displacement u (mm), dW/du, and returns the energy W
    /// (N mm); infinite, and the forces say nothing, where it turns an element inside out. Linear elements:
    /// exact; quadratic ones by the four points that integrate their stiffness, between which nothing is seen
    /// of what is turned inside out. No allocation.
    double forces(const Eigen::VectorXd& displacements, Eigen::VectorXd& forces) const noexcept;

  private:
    struct Element {
        elasticity::TetrahedronShape shape;
        Moduli moduli;
    };
    template <int nodes>
    double sum_forces(const Eigen::VectorXd& displacements, Eigen::VectorXd& forces) const noexcept;

    elasticity::Discretisation discretisation_;
    std::vector<std::int32_t> positions_;
    std::vector<Element> elements_;
    Eigen::Index dofs_ = 0;
};

}  // namespace palpate::hyperelasticity
