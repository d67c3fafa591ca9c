// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "formats/model/triangle_mesh.hpp"

namespace palpate::haptics {

/// Finds the triangles across the edges of each, that from corner k to k + 1 at k; the triangle itself across
/// an open edge. Linear, where few triangles meet at a vertex.
std::vector<std::array<std::int32_t, 3>> triangle_neighbours(const std::vector<Triangle>& triangles);

}  // namespace palpate::haptics
