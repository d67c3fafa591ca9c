// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "tools/meshing/labels/region_labels.hpp"
#include "tools/meshing/labels/smoothed_labels.hpp"
#include "tools/meshing/tetrahedra/size_field.hpp"

namespace palpate::meshing {

/// A point where two regions of SmoothedLabels meet.
struct SurfaceSeed {
    Eigen::Vector3d position;   ///< p_P, mm
    std::uint8_t lower, upper;  ///< the regions that meet, lower < upper; 0 is the outside
};

/// Scatters seeds over the surfaces of all components of all regions, 1.5 facet sizes apart or more, and
/// closer on small components, so that each gets some two dozen: Delaunay refinement finds only surfaces that
/// it has met, and a component between its first points would be lost. Equal inputs give equal seeds.
std::vector<SurfaceSeed> scatter_seeds(const RegionLabels& labels, const SmoothedLabels& smoothed,
                                       const SizeField& sizes);

}  // namespace palpate::meshing
