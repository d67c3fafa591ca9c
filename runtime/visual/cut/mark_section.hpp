// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "formats/model/triangle_mesh.hpp"
#include "runtime/visual/scan/scan_plane.hpp"

namespace palpate::visual {

/// Where a plane runs within a closed surface: 255 there and 0 elsewhere, `columns` by `rows` from the
/// plane's corner on, each of the middle of its cell, row by row. By the even-odd rule along rows, so where
/// surfaces overlap it tells the wrong side. Linear in triangles and cells.
std::vector<unsigned char> mark_section(const TriangleMesh& surface, const ScanPlane& plane, int columns,
                                        int rows);

}  // namespace palpate::visual
