// SPDX-License-Identifier: GPL-3.0-or-later
// CalculiX (ccx) as a judge: the same elements, materials and boundary written as its input deck, and its
// answer read back.
#pragma once
#include <Eigen/Core>
#include <map>

#include "tests/tools/fem/analytic/elastic_system.hpp"

namespace palpate::test {

/// What ccx answers, over the nodes of the system's discretisation.
struct CalculixAnswer {
    Eigen::VectorXd displacements;  ///< 3n, mm
    Eigen::VectorXd forces;         ///< 3n, N: reactions, zero where nothing is held
};

/// True if the executable ccx is on the path.
bool calculix_is_installed();

/// Runs ccx on a linear static step (no NLGEOM) with C3D4 or C3D10 elements, the materials of the body's
/// regions and the given supports, in a folder of its own under the temporary folder. Coordinates, moduli and
/// prescribed values are written with 13 digits, the most that its 20-character fields hold; its .dat table
/// gives 7 digits back, where its .frd file has 6. Throws std::runtime_error with ccx's talk if it gives no
/// answer.
CalculixAnswer ask_calculix(const ElasticSystem& system, const Supports& supports);

/// Displacements (3n, mm) of neo-Hookean tissue (formats/hyperelasticity/neo_hookean.hpp) at rest under nodal
/// forces (3n, N), held at the body's fixed nodes, as ccx has them: NLGEOM, forces balanced to 1e-7. Throws
/// as ask_calculix().
Eigen::VectorXd ask_calculix_neo_hookean(const DeformableBody& body, const Eigen::VectorXd& forces);

}  // namespace palpate::test
