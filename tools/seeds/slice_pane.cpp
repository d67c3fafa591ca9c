// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/seeds/slice_pane.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <vtkCamera.h>
#include <vtkCellArray.h>
#include <vtkFloatArray.h>
#include <vtkFlyingEdges2D.h>
#include <vtkImageMapper3D.h>
#include <vtkImageProperty.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkTextProperty.h>
#include <vtkUnsignedCharArray.h>

namespace palpate::seeds {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// Heights above the picture, towards the eye, mm. Points are drawn as balls, so the coloured ones must clear
// their black rims.
constexpr double contour_height = 1, crosshair_height = 2, rim_height = 3, seed_height = 50;
constexpr float rim_size = 13, seed_size = 9, contour_width = 2.2F;  // pixels
constexpr double near_slice = 3;                                     // mm: seeds no further off are drawn
constexpr double crosshair_gap = 14;                                 // pixels left free about the middle

void set_geometry(vtkImageData* image, const SlicePicture& picture, const Vector2d& voxel) {
    image->SetDimensions(picture.width, picture.height, 1);
    image->SetSpacing(voxel[0], voxel[1], 1);
    image->SetOrigin(voxel[0] / 2, voxel[1] / 2, 0);
}

// Keeps a text legible over a bright picture.
void set_backing(vtkTextActor* actor) {
    actor->GetTextProperty()->SetBackgroundColor(0, 0, 0);
    actor->GetTextProperty()->SetBackgroundOpacity(0.6);
}

}  // namespace

void set_viewport(vtkRenderer* renderer, const PaneFrame& frame, const Vector2d& window_size) {
    const Vector2d low = frame.corner.cwiseQuotient(window_size),
                   high = (frame.corner + frame.size).cwiseQuotient(window_size);
    renderer->SetViewport(low[0], low[1], high[0], high[1]);
}

void set_type(vtkTextActor* actor, int size) {
    vtkTextProperty* text = actor->GetTextProperty();
    text->SetFontFamilyToArial();
    text->SetFontSize(size);
    text->SetColor(0.93, 0.95, 0.97);
    text->SetLineSpacing(1.3);
}

SlicePane::SlicePane(const ImageGrid& grid, SliceView view) : grid_(grid), view_(std::move(view)) {
    renderer_->SetBackground(0, 0, 0);
    image_actor_->SetInputData(image_);
    image_actor_->GetMapper()->BorderOn();
    renderer_->AddActor(image_actor_);

    vtkSmartPointer<vtkActor> lines = add_actor(crosshair_, crosshair_height);
    lines->GetProperty()->SetColor(0.55, 0.85, 0.95);
    lines->GetProperty()->SetOpacity(0.6);
    vtkSmartPointer<vtkActor> rims = add_actor(seeds_, rim_height);
    rims->GetMapper()->ScalarVisibilityOff();
    rims->GetProperty()->SetColor(0, 0, 0);
    rims->GetProperty()->SetPointSize(rim_size);
    rims->GetProperty()->RenderPointsAsSpheresOn();
    vtkSmartPointer<vtkActor> dots = add_actor(seeds_, seed_height);
    dots->GetProperty()->SetPointSize(seed_size);
    dots->GetProperty()->RenderPointsAsSpheresOn();

    for (std::size_t edge = 0; edge < 4; ++edge) {
        set_type(letters_[edge], 18);
        letters_[edge]->GetTextProperty()->BoldOn();
        letters_[edge]->GetTextProperty()->SetJustificationToCentered();
        letters_[edge]->GetTextProperty()->SetVerticalJustificationToCentered();
        letters_[edge]->SetInput(std::string(1, view_.edges[edge]).c_str());
        set_backing(letters_[edge]);
        renderer_->AddActor2D(letters_[edge]);
    }
    set_type(title_, 13);
    title_->GetTextProperty()->SetColor(0.65, 0.72, 0.78);
    title_->GetTextProperty()->SetVerticalJustificationToTop();
    set_backing(title_);
    renderer_->AddActor2D(title_);

    // The eye is before the picture's z < 0 with v downwards, so u runs to the right.
    vtkCamera* camera = renderer_->GetActiveCamera();
    camera->ParallelProjectionOn();
    camera->SetViewUp(0, -1, 0);
}

vtkSmartPointer<vtkActor> SlicePane::add_actor(vtkPolyData* data, double height) {
    vtkNew<vtkPolyDataMapper> mapper;
    mapper->SetInputData(data);
    auto actor = vtkSmartPointer<vtkActor>::New();
    actor->SetMapper(mapper);
    actor->SetPosition(0, 0, -height);
    actor->GetProperty()->LightingOff();
    renderer_->AddActor(actor);
    return actor;
}

void SlicePane::update(const Volume& volume, const SeedState& state, const GreyPreset& grey,
                       const Growth* growth) {
    const auto across = static_cast<std::size_t>(view_.across);
    const std::int32_t slice = state.crosshair[across];
    const SlicePicture picture = slice_picture(volume, view_, slice, grey, growth, state.labels);
    set_geometry(image_, picture, {grid_.spacing[view_.right], grid_.spacing[view_.down]});
    image_->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
    std::ranges::copy(picture.rgb, static_cast<std::uint8_t*>(image_->GetScalarPointer()));
    image_->Modified();
    draw_contours(picture);
    draw_crosshair(state);
    draw_seeds(state);
    title_->SetInput(fmt::format("{}  {} / {}", view_.name, slice + 1, grid_.size[across]).c_str());
}

void SlicePane::draw_contours(const SlicePicture& picture) {
    for (std::size_t number = 0; number < picture.cover.size(); ++number) {
        if (number >= contours_.size()) {
            contours_.push_back(add_actor(nullptr, contour_height));
            const auto colour = label_colour(number);
            contours_[number]->GetProperty()->SetColor(colour[0], colour[1], colour[2]);
            contours_[number]->GetProperty()->SetLineWidth(contour_width);
        }
        contours_[number]->SetVisibility(!picture.cover[number].empty());
        if (picture.cover[number].empty()) continue;
        vtkNew<vtkImageData> cover;
        set_geometry(cover, picture, {grid_.spacing[view_.right], grid_.spacing[view_.down]});
        cover->AllocateScalars(VTK_FLOAT, 1);
        std::ranges::copy(picture.cover[number], static_cast<float*>(cover->GetScalarPointer()));
        vtkNew<vtkFlyingEdges2D> edges;
        edges->SetInputData(cover);
        edges->SetValue(0, 0.5);
        edges->ComputeScalarsOff();
        edges->Update();
        vtkPolyDataMapper::SafeDownCast(contours_[number]->GetMapper())->SetInputData(edges->GetOutput());
    }
}

void SlicePane::draw_crosshair(const SeedState& state) {
    const Vector3d index(state.crosshair[0], state.crosshair[1], state.crosshair[2]);
    const Vector2d middle = pane_point(view_, grid_, index), size = size_of(view_, grid_);
    const double gap = crosshair_gap * frame_.pixel;
    vtkNew<vtkPoints> points;
    vtkNew<vtkCellArray> lines;
    const auto line = [&](double u0, double v0, double u1, double v1) {
        if (u1 <= u0 && v1 <= v0) return;
        const vtkIdType first = points->InsertNextPoint(u0, v0, 0);
        lines->InsertNextCell({first, points->InsertNextPoint(u1, v1, 0)});
    };
    line(0, middle[1], middle[0] - gap, middle[1]);
    line(middle[0] + gap, middle[1], size[0], middle[1]);
    line(middle[0], 0, middle[0], middle[1] - gap);
    line(middle[0], middle[1] + gap, middle[0], size[1]);
    crosshair_->SetPoints(points);
    crosshair_->SetLines(lines);
}

void SlicePane::draw_seeds(const SeedState& state) {
    const double spacing = grid_.spacing[view_.across];
    const double reach = std::max(near_slice, spacing / 2 + 1e-6);
    vtkNew<vtkPoints> points;
    vtkNew<vtkCellArray> vertices;
    vtkNew<vtkUnsignedCharArray> colours;
    colours->SetNumberOfComponents(3);
    for (const imaging::Seed& seed : state.seeds) {
        const Vector3d index = grid_.index_of(seed.p_P);
        const double off = index[view_.across] - state.crosshair[view_.across];
        if (std::abs(off) * spacing > reach) continue;
        const Vector2d place = pane_point(view_, grid_, index);
        vertices->InsertNextCell({points->InsertNextPoint(place[0], place[1], 0)});
        const auto number = std::ranges::find(state.labels, seed.label) - state.labels.begin();
        for (const float channel : label_colour(static_cast<std::size_t>(number)))
            colours->InsertNextValue(static_cast<unsigned char>(std::lround(255 * channel)));
    }
    seeds_->SetPoints(points);
    seeds_->SetVerts(vertices);
    seeds_->GetPointData()->SetScalars(colours);
}

void SlicePane::place(const PaneFrame& frame, const Vector2d& window_size) {
    frame_ = frame;
    set_viewport(renderer_, frame, window_size);
    vtkCamera* camera = renderer_->GetActiveCamera();
    camera->SetFocalPoint(frame.center[0], frame.center[1], 0);
    camera->SetPosition(frame.center[0], frame.center[1], -100);
    camera->SetClippingRange(1, 200);
    camera->SetParallelScale(frame.size[1] * frame.pixel / 2);
    const Vector2d& s = frame.size;
    constexpr double inset = 13;
    letters_[0]->SetPosition(inset, s[1] / 2);
    letters_[1]->SetPosition(s[0] - inset, s[1] / 2);
    letters_[2]->SetPosition(s[0] / 2, s[1] - inset);
    letters_[3]->SetPosition(s[0] / 2, inset);
    title_->SetPosition(8, s[1] - 6);
}

}  // namespace palpate::seeds
