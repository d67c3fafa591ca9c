// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/bodies/soft_surface.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <vtkPointData.h>
#include <vtkProperty.h>

#include "runtime/visual/bodies/tissue_actor.hpp"

namespace palpate::visual {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

}  // namespace

SoftSurface::SoftSurface(const DeformableBody& body, const Vector3d& toward_eye, double grain,
                         vtkRenderer* renderer)
    : triangles_(body.boundary.surface.triangles) {
    for (const Vector3d& p : body.boundary.surface.vertices) rest_.push_back(p.cast<float>());
    const auto data = poly_data(body.boundary.surface, toward_eye);
    points_ = data->GetPoints();
    normals_ = vtkFloatArray::SafeDownCast(data->GetPointData()->GetNormals());
    grained_ = grained_tissue_actor(data, look_of(body), grain);
    plain_ = tissue_actor(data, look_of(body));
    for (const auto& actor : {grained_, plain_}) renderer->AddActor(actor);
    show_grain(true);
}

void SoftSurface::deform(const std::vector<Vector3f>& displacements) {
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

void SoftSurface::show_grain(bool on) {
    grained_->SetVisibility(on);
    plain_->SetVisibility(!on);
}

void SoftSurface::show_inside(bool on) {
    for (const auto& actor : {grained_, plain_}) actor->GetProperty()->SetBackfaceCulling(!on);
}

}  // namespace palpate::visual
