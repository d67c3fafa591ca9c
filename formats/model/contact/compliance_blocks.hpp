// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <vector>

#include "formats/model/body.hpp"

namespace palpate {

/// Returns the compliance block of each vertex of the body's surface, -1 for one that is fixed or left out of
/// the contact surface. Throws InvalidInput if compliance and contact nodes do not belong together.
std::vector<std::int32_t> compliance_blocks(const DeformableBody& body);

}  // namespace palpate
