// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "formats/model/triangle_mesh.hpp"

namespace palpate::meshing {

/// Turns vertices at exactly the same place into one, at the place of the first.
TriangleMesh joined_vertices(const TriangleMesh& surface);

}  // namespace palpate::meshing
