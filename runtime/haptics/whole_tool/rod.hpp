// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "formats/model/triangle_mesh.hpp"

namespace palpate::haptics {

/// The closed surface of a tool that has no body of its own: a ball of `radius` at the origin with a shaft as
/// thick, of `length` >= 0 along +z, ending in another ball; mm. 24 corners around.
TriangleMesh rod_surface(double radius, double length);

}  // namespace palpate::haptics
