// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <vector>

#include "formats/model/body.hpp"
#include "tools/fem/stiffness.hpp"

namespace palpate {

/// The stiffness of all free nodes in their own order.
struct FreeStiffness {
    LowerSparse lower;                       ///< N/mm
    std::vector<std::int64_t> surface_rows;  ///< row of each degree of freedom of the contact nodes
};

FreeStiffness free_stiffness(const DeformableBody& body);

}  // namespace palpate
