// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

namespace palpate::meshing {

/// Reads the triangles of an STL file, ASCII or binary; corners at the same place become one, triangles of
/// which two do are left out. Own code because VTK's reader goes by the count of a file that is neither.
/// Throws InvalidInput naming file and line. Source: 3D Systems, "StereoLithography interface specification",
/// 1989.
vtkSmartPointer<vtkPolyData> read_stl(const std::filesystem::path& path);

}  // namespace palpate::meshing
