// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include "tools/meshing/files/imported_mesh.hpp"

namespace palpate::meshing {

/// Reads the triangles of an STL file, ASCII or binary; corners at the same place become one, triangles of
/// which two do are left out. What is binary is told by its size and by the words of the text, and all of its
/// triangles are taken, whatever count it announces; `note` gets what differs. Own code because VTK's reader
/// goes by the count of a file that is neither. Throws InvalidInput naming file and line. Source: 3D Systems,
/// "StereoLithography interface specification", 1989.
vtkSmartPointer<vtkPolyData> read_stl(const std::filesystem::path& path, const NoteSink& note);

}  // namespace palpate::meshing
