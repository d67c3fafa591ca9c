// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/scan/cut_faces.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vtkCamera.h>
#include <vtkProperty.h>
#include <vtkShaderProperty.h>
#include <vtkUniforms.h>

#include "runtime/visual/hand/view_control.hpp"

namespace palpate::visual {
namespace {

using Eigen::Vector3d;

constexpr auto picture = "cutScan", reach = "cutReach";

// `cutReach`: half the near plane's width and height by its distance; 0 where nothing is painted. So the
// place in the picture follows from where the fragment lies before the eye, however many pixels are drawn.
// The tint keeps the scan's lightness: it is of the far side's hue, whose brightest channel it makes 1.
constexpr auto paint_far_sides =
    "  if (!gl_FrontFacing && cutReach.x > 0.0)\n"
    "    {\n"
    "    vec2 cutRay = vertexVC.xy / (-vertexVC.z * cutReach);\n"
    "    vec4 cutGrey = texture(cutScan, 0.5 + 0.5 * cutRay);\n"
    "    vec3 cutHue = ambientColor / max(max(ambientColor.r, ambientColor.g), max(ambientColor.b, 0.01));\n"
    "    gl_FragData[0].rgb =\n"
    "        mix(gl_FragData[0].rgb, cutGrey.rgb * mix(vec3(1.0), cutHue, 0.35), cutGrey.a);\n"
    "    }\n"
    "//VTK::TCoord::Impl";

ScanPlane near_plane(vtkRenderer* renderer) {
    vtkCamera* camera = renderer->GetActiveCamera();
    const auto [right, up, toward_eye] = view_axes(camera);
    const double distance = camera->GetClippingRange()[0],
                 height = 2 * distance * std::tan(camera->GetViewAngle() * std::numbers::pi / 180 / 2),
                 width = height * renderer->GetTiledAspectRatio();
    const Vector3d middle = Vector3d(camera->GetPosition()) - distance * toward_eye;
    return {middle - right * (width / 2) - up * (height / 2), right, up, width, height};
}

// Whether two planes show the same to a fiftieth of a texel.
bool same(const ScanPlane& a, const ScanPlane& b, double texel) {
    const auto corner = [](const ScanPlane& p, double across, double up) -> Vector3d {
        return p.corner + across * p.width * p.right + up * p.height * p.up;
    };
    double moved = 0;
    for (const auto& [across, up] : {std::array{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}})
        moved = std::max(moved, (corner(a, across, up) - corner(b, across, up)).norm());
    return moved < 0.02 * texel;
}

}  // namespace

CutFaces::CutFaces(const ScanImage& image) : sampler_(image) {}

void CutFaces::paint(vtkActor* actor) {
    actor->GetProperty()->SetTexture(picture, sampler_.texture());
    vtkShaderProperty* shader = actor->GetShaderProperty();
    shader->AddFragmentShaderReplacement("//VTK::TCoord::Impl", true, paint_far_sides, false);
    const std::array<float, 2> nowhere{0, 0};
    shader->GetFragmentCustomUniforms()->SetUniform2f(reach, nowhere.data());
    actors_.push_back(actor);
}

void CutFaces::follow(vtkRenderer* renderer, bool shown) {
    constexpr int columns = 320;  // a texel takes four pixels of 1280: finer than most scans
    const ScanPlane plane = near_plane(renderer);
    if (shown && !(sampled_ && same(*sampled_, plane, plane.width / columns))) {
        sampler_.sample(plane, columns, std::max(1, static_cast<int>(columns * plane.height / plane.width)));
        sampled_ = plane;
    }
    const double twice = 2 * renderer->GetActiveCamera()->GetClippingRange()[0];
    const std::array<float, 2> here{shown ? static_cast<float>(plane.width / twice) : 0,
                                    shown ? static_cast<float>(plane.height / twice) : 0};
    for (vtkActor* actor : actors_)
        actor->GetShaderProperty()->GetFragmentCustomUniforms()->SetUniform2f(reach, here.data());
}

}  // namespace palpate::visual
