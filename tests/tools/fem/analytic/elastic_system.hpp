// SPDX-License-Identifier: GPL-3.0-or-later
// A body's whole stiffness, with supports and loads that the solver itself does not offer: sliding supports,
// pressures, weights. What it shares with the solver is discretise() and assemble_stiffness(), nothing else.
#pragma once
#include <Eigen/Core>
#include <array>
#include <functional>
#include <vector>

#include "formats/elasticity/discretisation.hpp"
#include "formats/elasticity/stiffness.hpp"
#include "formats/model/body.hpp"

namespace palpate::test {

using Points = std::vector<Eigen::Vector3d>;
using Condition = std::function<bool(const Eigen::Vector3d&)>;
using VectorField = std::function<Eigen::Vector3d(const Eigen::Vector3d&)>;

/// All nodes of a body, middle nodes of edges among them, and the stiffness between them with nothing held.
struct ElasticSystem {
    DeformableBody body;
    elasticity::Discretisation discretisation;
    Points positions;                   ///< of every node, mm
    elasticity::LowerSparse stiffness;  ///< 3n x 3n, N/mm

    Eigen::Index dof_count() const { return static_cast<Eigen::Index>(3 * positions.size()); }
};

/// A body of one material and one region of value 1.
ElasticSystem elastic_system(TetMesh mesh, const Material& material, ElementOrder order);
ElasticSystem elastic_system(DeformableBody body);

/// Displacements that are known: a flag and a value (mm) per degree of freedom.
struct Supports {
    std::vector<bool> held;
    Eigen::VectorXd values;

    explicit Supports(const ElasticSystem& system);
    /// Holds one component (0, 1, 2) of every node that satisfies `condition` at `value`.
    void hold(const ElasticSystem& system, int component, const Condition& condition, double value = 0);
    /// Holds all components of every node that satisfies `condition` at the field's values.
    void impose(const ElasticSystem& system, const Condition& condition, const VectorField& field);
};

/// Solves for the displacements (3n x k, mm) under each column of nodal forces (3n x k, N), by Eigen's
/// interface to CHOLMOD with the held degrees of freedom eliminated.
Eigen::MatrixXd solve(const ElasticSystem& system, const Supports& supports, const Eigen::MatrixXd& forces);

/// The same under no load but the supports' own: 3n, mm.
Eigen::VectorXd solve(const ElasticSystem& system, const Supports& supports);

/// The nodal forces that keep a body displaced: K u, N.
Eigen::VectorXd nodal_forces(const ElasticSystem& system, const Eigen::VectorXd& displacements);

/// Nodal forces (3n, N) of the pressure p (N/mm²) on the boundary faces whose corners all satisfy
/// `condition`. Exact for flat faces: a third of the face's force on each corner, or on each edge's middle if
/// quadratic.
Eigen::VectorXd pressure_forces(const ElasticSystem& system, const Condition& condition, double pressure);

/// Nodal forces (3n, N) of a traction (N/mm²) on the boundary faces whose corners all satisfy `condition`.
Eigen::VectorXd traction_forces(const ElasticSystem& system, const Condition& condition,
                                const Eigen::Vector3d& traction);

/// Nodal forces (3n, N) of a constant force per volume, N/mm³: V/4 on each corner, or -V/20 on each corner
/// and V/5 on each edge's middle if quadratic.
Eigen::VectorXd body_forces(const ElasticSystem& system, const Eigen::Vector3d& per_volume);

}  // namespace palpate::test
