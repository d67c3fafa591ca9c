// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vtkSmartPointer.h>

#include "formats/model/triangle_mesh.hpp"

class vtkPolyData;

namespace palpate {

/// A surface as VTK's, with float points.
vtkSmartPointer<vtkPolyData> poly_data(const TriangleMesh& surface);

/// The triangles of a VTK surface; other cells are left out.
TriangleMesh triangle_mesh(vtkPolyData* data);

}  // namespace palpate
