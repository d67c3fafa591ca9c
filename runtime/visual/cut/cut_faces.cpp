// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/cut/cut_faces.hpp"

#include <algorithm>
#include <array>
#include <vtkProperty.h>
#include <vtkShaderProperty.h>
#include <vtkUniforms.h>

#include "runtime/visual/cut/near_plane.hpp"

namespace palpate::visual {
namespace {

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
    if (shown && !(sampled_ && show_the_same(*sampled_, plane, plane.width / columns))) {
        sampler_.sample(plane, columns, std::max(1, static_cast<int>(columns * plane.height / plane.width)));
        sampled_ = plane;
    }
    const Eigen::Vector2f here = shown ? near_reach(renderer).cast<float>().eval() : Eigen::Vector2f::Zero();
    for (vtkActor* actor : actors_)
        actor->GetShaderProperty()->GetFragmentCustomUniforms()->SetUniform2f(reach, here.data());
}

}  // namespace palpate::visual
