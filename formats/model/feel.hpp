// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "formats/records/felt_region.hpp"

namespace palpate {

/// What can be felt of a body with one tool.
struct Feel {
    double tool_radius = 0;  ///< mm
    double depth = 0;        ///< mm; of the press
    /// By surface vertex, N/mm: force on the tool pressed to `depth` along the inward normal, by `depth`; 0
    /// where the body cannot be touched.
    std::vector<float> stiffness;
    std::vector<FeltRegion> regions;  ///< every region but the largest, ascending; those without a neighbour
                                      ///< or a vertex near them left out
};

}  // namespace palpate
