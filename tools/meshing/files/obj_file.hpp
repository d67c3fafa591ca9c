// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

namespace palpate::meshing {

/// Reads vertices (v) and faces (f) of a Wavefront OBJ file and nothing else; faces may name vertices that
/// are not there. Own code because VTK's reader crashes on a face whose texture is missing. Throws
/// InvalidInput naming file and line. Source: Wavefront, "Advanced Visualizer manual", appendix B1.
vtkSmartPointer<vtkPolyData> read_obj(const std::filesystem::path& path);

}  // namespace palpate::meshing
