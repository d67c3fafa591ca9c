// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "formats/model/triangle_mesh.hpp"

namespace palpate {

/// Reduces a surface to about `budget` triangles, for the eye only: the haptic side keeps the whole surface.
/// Vertices are clustered on a grid, so it costs tens of milliseconds for 350 000 triangles, but thin walls
/// may close. A surface within the budget comes back as it is.
TriangleMesh display_copy(const TriangleMesh& surface, std::int64_t budget);

}  // namespace palpate
