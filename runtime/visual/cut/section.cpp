// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/cut/section.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>
#include <vtkCamera.h>
#include <vtkCellArray.h>
#include <vtkNew.h>
#include <vtkPolyData.h>
#include <vtkProperty.h>
#include <vtkShaderProperty.h>
#include <vtkTexture.h>
#include <vtkUniforms.h>

#include "runtime/visual/cut/mark_section.hpp"
#include "runtime/visual/cut/near_plane.hpp"
#include "runtime/visual/tissue/tissue_actor.hpp"

namespace palpate::visual {
namespace {

using Eigen::Vector3d;

constexpr auto picture = "section", reach = "sectionReach";

// `sectionReach`: near_reach(), so that the place in the picture follows from where the fragment lies.
constexpr auto leave_out_what_is_no_body =
    "  vec2 sectionRay = vertexVC.xy / (-vertexVC.z * sectionReach);\n"
    "  if (texture(section, 0.5 + 0.5 * sectionRay).r < 0.5) discard;\n"
    "//VTK::Color::Impl";

}  // namespace

Section::Section(const TriangleMesh& surface, const TissueLook& look, vtkRenderer* renderer)
    : surface_(&surface),
      corners_(vtkSmartPointer<vtkPoints>::New()),
      marks_(vtkSmartPointer<vtkImageData>::New()) {
    corners_->SetDataTypeToDouble();
    corners_->SetNumberOfPoints(4);
    vtkNew<vtkCellArray> rectangle;
    rectangle->InsertNextCell({0, 1, 2, 3});
    vtkNew<vtkPolyData> data;
    data->SetPoints(corners_);
    data->SetPolys(rectangle);
    actor_ = tissue_actor(data, look);
    vtkNew<vtkTexture> texture;
    texture->SetInputData(marks_);
    texture->InterpolateOn();
    texture->RepeatOff();
    texture->EdgeClampOn();
    actor_->GetProperty()->SetTexture(picture, texture);
    actor_->GetShaderProperty()->AddFragmentShaderReplacement("//VTK::Color::Impl", true,
                                                              leave_out_what_is_no_body, false);
    actor_->VisibilityOff();
    renderer->AddActor(actor_);
}

void Section::follow(vtkRenderer* renderer, bool shown) {
    actor_->SetVisibility(shown);
    if (!shown) return;
    const ScanPlane plane = near_plane(renderer);
    place(plane, Vector3d(renderer->GetActiveCamera()->GetPosition()));
    const Eigen::Vector2f here = near_reach(renderer).cast<float>();
    actor_->GetShaderProperty()->GetFragmentCustomUniforms()->SetUniform2f(reach, here.data());
    constexpr int columns = 640;  // a cell takes two pixels of 1280
    if (!marked_ || !show_the_same(*marked_, plane, plane.width / columns)) mark(plane, columns);
    actor_->SetVisibility(cuts_);
}

void Section::place(const ScanPlane& plane, const Vector3d& eye) {
    constexpr double behind = 2e-5;  // of its distance from the eye: not clipped, and nothing lies between
    const Vector3d up = plane.height * plane.up, right = plane.width * plane.right;
    // Clockwise, as the eye sees it: it shows its back.
    const std::array<Vector3d, 4> around{Vector3d::Zero(), up, up + right, right};
    for (vtkIdType i = 0; i < 4; ++i) {
        const Vector3d corner = plane.corner + around[static_cast<std::size_t>(i)];
        corners_->SetPoint(i, Vector3d(corner + behind * (corner - eye)).data());
    }
    corners_->Modified();
}

void Section::mark(const ScanPlane& plane, int columns) {
    marked_ = plane;
    const int rows = std::max(1, static_cast<int>(std::lround(columns * plane.height / plane.width)));
    marks_->SetDimensions(columns, rows, 1);
    marks_->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
    const std::vector<unsigned char> marks = mark_section(*surface_, plane, columns, rows);
    std::ranges::copy(marks, static_cast<unsigned char*>(marks_->GetScalarPointer()));
    marks_->Modified();
    cuts_ = std::ranges::find(marks, 255) != marks.end();
}

}  // namespace palpate::visual
