// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/cut/near_plane.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "runtime/visual/hand/view_control.hpp"

namespace palpate::visual {

using Eigen::Vector3d;

namespace {

constexpr double clear_share = 0.04;  // of the field: what is left before the target
constexpr double clear_radii = 3;     // tool radii that are left before the tool

}  // namespace

void clip_before(vtkCamera* camera, double depth) {
    const double far = camera->GetClippingRange()[1];
    camera->SetClippingRange(std::max(depth, 1e-3 * far), far);
}

void clip_before(vtkCamera* camera, const Sight& sight, const Vector3d& tool, double tool_radius) {
    clip_before(camera, std::min(depth_of(camera, sight.target) - clear_share * sight.field,
                                 depth_of(camera, tool) - clear_radii * tool_radius));
}

Eigen::Vector2d near_reach(vtkRenderer* renderer) {
    const double up = std::tan(renderer->GetActiveCamera()->GetViewAngle() * std::numbers::pi / 180 / 2);
    return {up * renderer->GetTiledAspectRatio(), up};
}

ScanPlane near_plane(vtkRenderer* renderer) {
    vtkCamera* camera = renderer->GetActiveCamera();
    const auto [right, up, toward_eye] = view_axes(camera);
    const double distance = camera->GetClippingRange()[0];
    const Eigen::Vector2d half = distance * near_reach(renderer);
    const Vector3d middle = Vector3d(camera->GetPosition()) - distance * toward_eye;
    return {middle - right * half.x() - up * half.y(), right, up, 2 * half.x(), 2 * half.y()};
}

bool show_the_same(const ScanPlane& a, const ScanPlane& b, double texel) {
    const auto corner = [](const ScanPlane& p, double across, double up) -> Vector3d {
        return p.corner + across * p.width * p.right + up * p.height * p.up;
    };
    double moved = 0;
    for (const auto& [across, up] : {std::array{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}})
        moved = std::max(moved, (corner(a, across, up) - corner(b, across, up)).norm());
    return moved < 0.02 * texel;
}

}  // namespace palpate::visual
