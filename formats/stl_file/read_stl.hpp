// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>

#include "formats/model/triangle_mesh.hpp"

namespace palpate::stl_file {

/// Reads the surface of a solid, in the file's own frame (mm), from STL, binary or ASCII in any case. A file
/// is binary if it has the 84 + 50 n bytes of the n triangles it announces, whatever its header says; the
/// normals of facets are passed over. Corners of the very same float32 coordinates become one vertex, in the
/// order in which the file first names them; a triangle with two corners in one place is left out. A surface
/// that is inside out, of negative volume sum p0 . (p1 x p2) / 6, is turned round. Throws InvalidInput, with
/// the line of an ASCII file, for what is no file or cannot be read, is larger than 84 + 50 * 2^20 bytes (a
/// binary file of 2^20 triangles), is neither form or cut short; for a corner that is not finite or has a
/// coordinate beyond 10^4 mm; for a surface without triangles, with an edge that is not shared by exactly two
/// triangles in opposite directions, or without volume. Cost: O(n log n) time and less than 400 bytes of
/// memory a triangle. Source: 3D Systems, "StereoLithography interface specification", 1989.
TriangleMesh read_stl(const std::filesystem::path& path);

}  // namespace palpate::stl_file
