// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/bodies/moving_surface.hpp"

#include <algorithm>
#include <vtkPointData.h>

#include "runtime/visual/actors.hpp"

namespace palpate::visual {

using Eigen::Vector3f;

MovingSurface::MovingSurface(const TriangleMesh& rest, const Eigen::Vector3d& toward_eye)
    : triangles_(rest.triangles),
      data_(poly_data(rest, toward_eye)),
      points_(data_->GetPoints()),
      normals_(vtkFloatArray::SafeDownCast(data_->GetPointData()->GetNormals())) {
    for (const Eigen::Vector3d& p : rest.vertices) rest_.push_back(p.cast<float>());
}

void MovingSurface::displace(std::span<const Vector3f> displacements) {
    const bool moves = std::ranges::any_of(displacements, [](const Vector3f& u) { return !u.isZero(0); });
    if (!moves && !displaced_) return;
    displaced_ = moves;
    // Three floats a point, as in VTK's arrays.
    static_assert(sizeof(Vector3f) == 3 * sizeof(float));
    const std::span points(static_cast<Vector3f*>(points_->GetVoidPointer(0)), rest_.size());
    for (std::size_t i = 0; i < rest_.size(); ++i) points[i] = rest_[i] + displacements[i];
    vertex_normals(points, triangles_, {reinterpret_cast<Vector3f*>(normals_->GetPointer(0)), rest_.size()});
    points_->Modified();
    normals_->Modified();
}

}  // namespace palpate::visual
