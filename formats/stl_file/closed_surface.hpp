// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "formats/model/triangle_mesh.hpp"
#include "formats/stl_file/facets.hpp"

namespace palpate::stl_file {

/// The solid's surface whose triangles have these corners, three each: one vertex for each place, without
/// triangles of two corners in one place, outward. Throws InvalidInput naming `file` if it is empty, not
/// closed or without volume.
TriangleMesh closed_surface(const std::vector<Corner>& corners, const std::string& file);

}  // namespace palpate::stl_file
