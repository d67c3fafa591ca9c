// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>

#include "formats/model/tet_mesh.hpp"
#include "formats/model/triangle_mesh.hpp"

namespace palpate::meshing {

/// Reads a triangle surface (VTK XML PolyData, `.vtp`); coordinates are taken as LPS mm. Throws InvalidInput
/// naming the file if it is no such file, holds other cells than triangles, an index out of range or a number
/// that is not finite, says that it is RAS, or is empty. Whether the surface is closed is
/// measure(const TriangleMesh&)'s to say.
TriangleMesh read_surface(const std::filesystem::path& path);

/// Writes a surface as `.vtp`: float64 points, int32 indices, appended and compressed, FieldData SPACE=LPS.
/// Equal meshes give equal bytes. Throws SystemFailure if the file cannot be written whole.
void write_surface(const std::filesystem::path& path, const TriangleMesh& surface);

/// Reads tetrahedra (VTK XML UnstructuredGrid, `.vtu`); coordinates are taken as LPS mm. Without CellData
/// `region` every tetrahedron belongs to region 1; regions without a name are called "region <value>".
/// Checks as read_surface() does, and that every volume is positive (naming the first tetrahedron that is
/// not).
TetMesh read_tetrahedra(const std::filesystem::path& path);

/// Writes tetrahedra as `.vtu` with CellData `region`, PointData `outside_label` (if the mesh has it), and in
/// FieldData the names, values and colours of both and SPACE=LPS. Bytes and errors as write_surface().
void write_tetrahedra(const std::filesystem::path& path, const TetMesh& mesh);

}  // namespace palpate::meshing
