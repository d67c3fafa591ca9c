// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <string_view>

#include "formats/model/label_map.hpp"
#include "formats/model/tet_mesh.hpp"
#include "formats/model/triangle_mesh.hpp"

namespace palpate::meshing {

using NoteSink = std::function<void(std::string_view)>;

/// How to understand a mesh that somebody made elsewhere.
struct ImportedMeshOptions {
    std::string unit = "mm";  ///< of the file's coordinates: um, mm, cm, m or in
    std::string frame{};      ///< "lps" or "ras"; empty: what the file states, else LPS
    std::map<std::int32_t, std::string> region_names{};  ///< of the file's region values
};

/// Reads tetrahedra made elsewhere: `.vtu`, legacy `.vtk`, Gmsh `.msh` (1, 2.2, 4.1), MEDIT `.mesh`.
/// Positions become mm in LPS. Regions come from CellData region, medit:ref, gmsh:physical or
/// gmsh:geometrical, Gmsh's physical groups or MEDIT's references; without any, all is region 1. Values
/// that are no label (1 ... 65535) get the lowest free one, with a note. Names are options.region_names, the
/// file's own, or "region <value>". `outside_labels` is 0 at the surface.
///
/// Repaired, with a note: inverted tetrahedra (two nodes change places), unused nodes, tetrahedra that are
/// there twice, parts that touch in a point or edge only (their nodes are doubled). Ignored, with a note:
/// points, lines, triangles. Refused with InvalidInput naming the place and the next step: other solid cells,
/// tetrahedra without volume, three or more at one face, two that overlap at a face, faces that lie on each
/// other without sharing nodes, names for absent regions, unreadable or unknown files.
/// Cost: O(n log n).
TetMesh read_imported_tetrahedra(const std::filesystem::path& path, const ImportedMeshOptions& options,
                                 const NoteSink& note = {});

/// Tetrahedra as a file has them.
struct UnrepairedTetrahedra {
    TetMesh mesh;  ///< mm, LPS; some may be inverted, flat or there twice
    std::map<std::string, std::int64_t> other_cells{};  ///< by kind: "triangle", "hexahedron"
};

/// Reads what read_imported_tetrahedra() reads and looks no further than its indices: nothing is mended but
/// that unused nodes are left out, and of what that refuses only a file without tetrahedra and one that
/// cannot be read.
UnrepairedTetrahedra read_unrepaired_tetrahedra(const std::filesystem::path& path,
                                                const ImportedMeshOptions& options,
                                                const NoteSink& note = {});

/// Fits an imported mesh into the label map of its patient: regions take value and colour of the label of
/// their name, those without one a value that no label has, and `outside_labels` says what the map has beyond
/// the surface. Throws InvalidInput if no region has a label's name.
void adopt_labels(TetMesh& mesh, const LabelMap& map);

/// Reads a triangle surface made elsewhere: `.vtp`, legacy `.vtk`, `.stl`, `.obj`, `.ply`. Points at the same
/// place become one, polygons are split into triangles, and repaired_surface() makes the rest sound. Throws
/// InvalidInput as that does, and for unreadable or unknown files.
TriangleMesh read_imported_surface(const std::filesystem::path& path, const ImportedMeshOptions& options,
                                   const NoteSink& note = {});

/// The same before anything is mended, and with points at the same place as the file has them.
TriangleMesh read_unrepaired_surface(const std::filesystem::path& path, const ImportedMeshOptions& options,
                                     const NoteSink& note = {});

}  // namespace palpate::meshing
