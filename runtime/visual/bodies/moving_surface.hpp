// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <span>
#include <vector>
#include <vtkFloatArray.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include "formats/model/triangle_mesh.hpp"

namespace palpate::visual {

/// A surface as VTK draws it, whose vertices move.
class MovingSurface {
  public:
    MovingSurface(const TriangleMesh& rest, const Eigen::Vector3d& toward_eye);

    /// What actors are to draw: its points and normals follow.
    vtkPolyData* data() const { return data_; }

    /// Moves the vertices from rest, by one displacement (mm) each.
    void displace(std::span<const Eigen::Vector3f> displacements);

  private:
    std::vector<Eigen::Vector3f> rest_;
    std::vector<Triangle> triangles_;
    bool displaced_ = false;
    vtkSmartPointer<vtkPolyData> data_;
    vtkSmartPointer<vtkPoints> points_;
    vtkSmartPointer<vtkFloatArray> normals_;
};

}  // namespace palpate::visual
