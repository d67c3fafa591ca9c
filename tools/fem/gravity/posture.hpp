// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "formats/model/body.hpp"

namespace palpate::fem {

/// Density of a region.
struct RegionDensity {
    std::int32_t region = 0;  ///< label value as in TetMesh::regions
    double density = 0;       ///< kg/m³
};

/// What a change of posture did to a body.
struct Sag {
    double largest_displacement = 0;  ///< mm
    double largest_stretch = 0;       ///< of an edge: change of its length by its length
};

/// The words for postures, for messages.
inline constexpr const char* posture_grammar =
    "supine, prone, left_side, right_side (lying on it), upright, or X,Y,Z: which way gravity points";

/// Gravity in a posture, N/kg, frame P (LPS): 9.81 along its direction. Throws UsageError of `culprit` for
/// a word that is no posture and for a direction that is zero or not finite.
Eigen::Vector3d gravity_in(const std::string& posture, const std::string& culprit);

/// How mesh nodes move, mm, where gravity changes by `change` (N/kg, frame P): K u = rho V change, linear, so
/// that what tissue already bears in the posture of its scan stays in its shape. Consistent loads: a quarter
/// of an element's weight on each of 4 corners; of 10 nodes -1/20 on corners and 1/5 on middles. Reads mesh,
/// materials, element order and fixed nodes of a prepared_body(). Throws InvalidInput naming a region without
/// density. One sparse factorisation.
std::vector<Eigen::Vector3d> displacements_under(const DeformableBody& body,
                                                 std::span<const RegionDensity> densities,
                                                 const Eigen::Vector3d& change);

/// Moves the rest positions of mesh and surface. Throws InvalidInput if a tetrahedron would turn over, naming
/// it and what to change.
Sag move_at_rest(DeformableBody& body, std::span<const Eigen::Vector3d> displacements);

}  // namespace palpate::fem
