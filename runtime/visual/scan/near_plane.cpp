// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/scan/near_plane.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vtkCamera.h>

#include "runtime/visual/hand/view_control.hpp"

namespace palpate::visual {

using Eigen::Vector3d;

ScanPlane near_plane(vtkRenderer* renderer) {
    vtkCamera* camera = renderer->GetActiveCamera();
    const auto [right, up, toward_eye] = view_axes(camera);
    const double distance = camera->GetClippingRange()[0],
                 height = 2 * distance * std::tan(camera->GetViewAngle() * std::numbers::pi / 180 / 2),
                 width = height * renderer->GetTiledAspectRatio();
    const Vector3d middle = Vector3d(camera->GetPosition()) - distance * toward_eye;
    return {middle - right * (width / 2) - up * (height / 2), right, up, width, height};
}

std::array<float, 2> near_reach(vtkRenderer* renderer) {
    const ScanPlane plane = near_plane(renderer);
    const double twice = 2 * renderer->GetActiveCamera()->GetClippingRange()[0];
    return {static_cast<float>(plane.width / twice), static_cast<float>(plane.height / twice)};
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
