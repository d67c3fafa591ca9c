// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/hand/view_control.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

namespace palpate::visual {
namespace {

using Eigen::Vector3d;

constexpr double turn_deg = 0.35;  // a pixel

Vector3d world_of(vtkRenderer* renderer, double x, double y, double depth) {
    renderer->SetDisplayPoint(x, y, depth);
    renderer->DisplayToWorld();
    const double* p = renderer->GetWorldPoint();
    return Vector3d(p[0], p[1], p[2]) / p[3];
}

}  // namespace

std::array<Vector3d, 3> view_axes(vtkCamera* camera) {
    camera->OrthogonalizeViewUp();
    const Vector3d eye = -Vector3d(camera->GetDirectionOfProjection());
    const Vector3d up = Vector3d(camera->GetViewUp());
    return {up.cross(eye), up, eye};
}

void look_from(vtkCamera* camera, const Sight& sight) {
    const Vector3d eye = sight.eye(), up = sight.axes().col(1);
    camera->SetViewAngle(sight.view_angle_deg);
    camera->SetFocalPoint(sight.focus.data());
    camera->SetPosition(eye.data());
    camera->SetViewUp(up.data());
    camera->OrthogonalizeViewUp();
}

std::array<Vector3d, 2> segment_under(vtkRenderer* renderer, double x, double y) {
    return {world_of(renderer, x, y, 0), world_of(renderer, x, y, 1)};
}

void turn_view(vtkCamera* camera, double dx, double dy) {
    camera->Azimuth(-turn_deg * dx);
    camera->Elevation(-turn_deg * dy);
    camera->OrthogonalizeViewUp();
}

void roll_view(vtkCamera* camera, double dx) {
    camera->Roll(turn_deg * dx);
}

void pan_view(vtkCamera* camera, double dx, double dy, int window_height) {
    const Vector3d focus(camera->GetFocalPoint());
    const Vector3d way = -way_of_drag(camera, dx, dy, camera->GetDistance(), window_height);
    const Vector3d new_focus = focus + way, new_place = Vector3d(camera->GetPosition()) + way;
    camera->SetFocalPoint(new_focus.data());
    camera->SetPosition(new_place.data());
}

Vector3d way_of_drag(vtkCamera* camera, double dx, double dy, double depth, int window_height) {
    const auto [right, up, eye] = view_axes(camera);
    const double pixel_mm =
        2 * depth * std::tan(camera->GetViewAngle() * std::numbers::pi / 360) / window_height;
    return (right * dx + up * dy) * pixel_mm;
}

double depth_of(vtkCamera* camera, const Vector3d& place) {
    return view_axes(camera)[2].dot(Vector3d(camera->GetPosition()) - place);
}

}  // namespace palpate::visual
