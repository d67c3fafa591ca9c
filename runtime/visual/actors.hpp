// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <span>
#include <vector>
#include <vtkActor.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include "formats/model/triangle_mesh.hpp"

namespace palpate::visual {

/// A colour as three channels of 0 ... 255.
using Rgb = Eigen::Vector3f;

/// Area-weighted unit normals of the vertices.
void vertex_normals(std::span<const Eigen::Vector3f> positions, std::span<const Triangle> triangles,
                    std::span<Eigen::Vector3f> normals);

/// A surface as VTK's, with float points and normals. Triangles come in the order in which they are drawn:
/// nearest to the eye first, so that software rendering shades little that something else covers.
vtkSmartPointer<vtkPolyData> poly_data(const TriangleMesh& surface, const Eigen::Vector3d& toward_eye);

/// Draws `data` in one colour.
vtkSmartPointer<vtkActor> actor(vtkPolyData* data, const Rgb& colour);

void set_colour(vtkActor* actor, const Rgb& colour);

/// Places an actor, turned, its origin at `origin` (mm).
void place_turned(vtkActor* actor, const Eigen::Vector3d& origin, const Eigen::Quaterniond& orientation);

/// Places what was modelled along the x axis: turned to `way` (unit), scaled, its origin at `origin`.
void place_along(vtkActor* actor, const Eigen::Vector3d& origin, const Eigen::Vector3d& way, double scale);

/// Stretches what was modelled along the x axis, 1 long and 1 wide, from `a` to `b` (mm), and makes it
/// `width` (mm) wide.
void stretch_between(vtkActor* actor, const Eigen::Vector3d& a, const Eigen::Vector3d& b, double width);

}  // namespace palpate::visual
