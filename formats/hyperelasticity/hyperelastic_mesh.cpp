// SPDX-License-Identifier: Apache-2.0
#include "formats/hyperelasticity/hyperelastic_mesh.hpp"

#include <algorithm>
#include <limits>
#include <map>

#include "formats/elasticity/stiffness.hpp"

namespace palpate::hyperelasticity {

using namespace elasticity;
using Eigen::Index;

HyperelasticMesh::HyperelasticMesh(const DeformableBody& body)
    : discretisation_(discretise(body)),
      positions_(number_free_nodes(discretisation_.node_count, discretisation_.fixed_nodes)),
      dofs_(3 * static_cast<Index>(discretisation_.node_count - discretisation_.fixed_nodes.size())) {
    require_sound_materials(body.mesh, body.materials);
    std::map<std::int32_t, Moduli> moduli;
    for (const auto& [region, material] : body.materials) moduli[region] = moduli_of(material);
    for (std::size_t t = 0; t < body.mesh.tetrahedra.size(); ++t)
        elements_.push_back({shape_of(corners_of(body.mesh, t)), moduli[body.mesh.regions[t]]});
}

// The shape functions' gradients where an element is integrated, and the part of its volume there.
template <int nodes>
struct Quadrature;
template <>
struct Quadrature<4> {
    static constexpr Index points = 1;
    static Eigen::Matrix<double, 3, 4> gradients(const TetrahedronShape& shape, Index) {
        return shape.gradients;
    }
};
template <>
struct Quadrature<10> {
    static constexpr Index points = 4;
    static Eigen::Matrix<double, 3, 10> gradients(const TetrahedronShape& shape, Index point) {
        return quadratic_gradients(shape.gradients, quadrature_point(point));
    }
};

template <int nodes>
double HyperelasticMesh::sum_forces(const Eigen::VectorXd& displacements,
                                    Eigen::VectorXd& forces) const noexcept {
    forces.setZero();
    double energy = 0;
    for (std::size_t t = 0; t < elements_.size(); ++t) {
        const Element& element = elements_[t];
        const auto of_element = nodes_of_element(discretisation_, t);
        std::array<std::int32_t, nodes> places;
        std::ranges::transform(of_element, places.begin(),
                               [&](std::int32_t node) { return positions_[static_cast<std::size_t>(node)]; });
        Eigen::Matrix<double, 3, nodes> moved = Eigen::Matrix<double, 3, nodes>::Zero(), pull = moved;
        for (std::size_t a = 0; a < nodes; ++a)
            if (places[a] >= 0)
                moved.col(static_cast<Index>(a)) = displacements.segment<3>(3 * Index{places[a]});
        const double volume = element.shape.volume / static_cast<double>(Quadrature<nodes>::points);
        for (Index point = 0; point < Quadrature<nodes>::points; ++point) {
            const auto gradients = Quadrature<nodes>::gradients(element.shape, point);
            Eigen::Matrix3d F;
            F.noalias() = moved * gradients.transpose();
            F.diagonal().array() += 1;
            const Stressed stressed = neo_hookean(F, element.moduli);
            energy += volume * stressed.energy;
            pull.noalias() += volume * stressed.stress * gradients;
        }
        if (energy == std::numeric_limits<double>::infinity()) return energy;
        for (std::size_t a = 0; a < nodes; ++a)
            if (places[a] >= 0) forces.segment<3>(3 * Index{places[a]}) += pull.col(static_cast<Index>(a));
    }
    return energy;
}

double HyperelasticMesh::forces(const Eigen::VectorXd& displacements,
                                Eigen::VectorXd& forces) const noexcept {
    return discretisation_.nodes_per_element == 4 ? sum_forces<4>(displacements, forces)
                                                  : sum_forces<10>(displacements, forces);
}

}  // namespace palpate::hyperelasticity
