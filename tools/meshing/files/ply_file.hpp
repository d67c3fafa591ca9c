// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

namespace palpate::meshing {

/// Reads vertices and faces of a PLY file, ASCII or binary of either byte order; faces may name vertices that
/// are not there. Own code because VTK's reader trusts the counts in a file and crashes on wrong ones. Throws
/// InvalidInput naming file and line. Source: Turk, "The PLY polygon file format", 1994.
vtkSmartPointer<vtkPolyData> read_ply(const std::filesystem::path& path);

}  // namespace palpate::meshing
