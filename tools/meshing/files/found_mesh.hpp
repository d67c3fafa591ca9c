// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "formats/model/tet_mesh.hpp"

namespace palpate::meshing {

/// What a file says, before any check: tetrahedra in the file's own unit and frame.
struct FoundTetrahedra {
    std::vector<Eigen::Vector3d> points;
    std::vector<Tetrahedron> tetrahedra;        ///< indices into `points`, in range
    std::vector<std::int32_t> regions;          ///< one per tetrahedron; empty if the file has none
    std::string regions_from;                   ///< what they were read from, for people
    std::vector<Label> names;                   ///< of region values, as far as the file names them
    std::map<std::string, std::int64_t> flat;   ///< cells that fill no space, by kind: "triangle"
    std::map<std::string, std::int64_t> solid;  ///< cells that do and are no linear tetrahedra: "hexahedron"
    std::string space;                          ///< "LPS" or "RAS" if the file states it
};

/// Reads Gmsh's own format, version 1, 2.2 or 4.1, 2.2 and 4.1 also binary. Regions are physical groups of
/// volumes with their names or, where no tetrahedron is in one, geometrical entities. Throws InvalidInput
/// naming file and line. Source: Gmsh reference manual, "File formats" and "Legacy formats".
FoundTetrahedra read_gmsh(const std::filesystem::path& path);

/// Reads MEDIT's ASCII format; regions are the tetrahedra's references. Throws InvalidInput naming file and
/// line. Source: Frey, "MEDIT: an interactive mesh visualization software", 2001.
FoundTetrahedra read_medit(const std::filesystem::path& path);

/// Reads VTK XML (.vtu) or legacy (.vtk) unstructured grids; regions are the first of the cell arrays region,
/// medit:ref, gmsh:physical and gmsh:geometrical. Throws InvalidInput naming the file.
FoundTetrahedra read_vtk_grid(const std::filesystem::path& path);

}  // namespace palpate::meshing
