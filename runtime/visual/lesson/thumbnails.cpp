// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/lesson/thumbnails.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vtkCamera.h>
#include <vtkPointData.h>
#include <vtkRendererCollection.h>
#include <vtkUnsignedCharArray.h>

#include "runtime/visual/cut/near_plane.hpp"
#include "runtime/visual/hand/view_control.hpp"

namespace palpate::visual {
namespace {

using Eigen::Vector3d;

constexpr double thumbnail_angle_deg = 30;
constexpr double room_about_marks = 1.5;  // how much more than the marks themselves is seen
constexpr double least_field = 0.25;      // of the first view's
constexpr double whole_zoom = 1.4;        // VTK leaves room for a ball about the case
constexpr double cut_before_marks = 0.1;  // of what is seen: how far before the marks a cut lies

Eigen::AlignedBox3d box_of(const LessonPicture& picture) {
    Eigen::AlignedBox3d box;
    for (const LessonMark& mark : picture.marks) box.extend(mark.place);
    for (const Vector3d& point : picture.line) box.extend(point);
    return box;
}

// Draws one renderer of a window alone, without showing it.
void draw_unseen(vtkRenderWindow* window, vtkRenderer* alone) {
    std::vector<vtkRenderer*> others;
    vtkCollectionSimpleIterator at;
    window->GetRenderers()->InitTraversal(at);
    while (vtkRenderer* renderer = window->GetRenderers()->GetNextRenderer(at))
        if (renderer != alone && renderer->GetDraw() != 0) others.push_back(renderer);
    for (vtkRenderer* renderer : others) renderer->DrawOff();
    alone->DrawOn();
    window->SwapBuffersOff();
    window->Render();
    window->SwapBuffersOn();
    alone->DrawOff();
    for (vtkRenderer* renderer : others) renderer->DrawOn();
}

}  // namespace

Thumbnails::Thumbnails(vtkRenderWindow* window, const Sight& sight)
    : window_(window), sight_(sight), marks_(renderer_) {
    renderer_->DrawOff();
    renderer_->SetBackground(0.10, 0.13, 0.16);
    window->AddRenderer(renderer_);
}

void Thumbnails::take_next(const LessonPage& page, double scale) {
    const int enlarged = std::max(1, static_cast<int>(std::ceil(scale - 1e-9)));
    if (enlarged != enlarged_) taken_.clear();
    enlarged_ = enlarged;
    if (page.picture && picture_of(*page.picture) == nullptr) return take(*page.picture);
    for (const LessonChoice& choice : page.choices)
        if (choice.picture && picture_of(*choice.picture) == nullptr) return take(*choice.picture);
}

vtkImageData* Thumbnails::picture_of(const LessonPicture& picture) const {
    const auto found =
        std::ranges::find_if(taken_, [&](const auto& taken) { return taken.first == picture; });
    return found != taken_.end() ? found->second.Get() : nullptr;
}

void Thumbnails::take(const LessonPicture& picture) {
    const int* size = window_->GetSize();
    const int wide = std::min(size[0], enlarged_ * width), high = std::min(size[1], enlarged_ * height);
    renderer_->SetViewport(0, 0, static_cast<double>(wide) / size[0], static_cast<double>(high) / size[1]);
    LessonView view;
    view.marks = picture.marks;
    view.line = picture.line;
    view.line_radius = picture.line_radius;
    marks_.update(view);
    look_at(picture);
    draw_unseen(window_, renderer_);
    vtkNew<vtkUnsignedCharArray> pixels;
    window_->GetPixelData(0, 0, wide - 1, high - 1, 0, pixels);
    const auto image = vtkSmartPointer<vtkImageData>::New();
    image->SetDimensions(wide, high, 1);
    image->GetPointData()->SetScalars(pixels);
    taken_.emplace_back(picture, image);
}

void Thumbnails::look_at(const LessonPicture& picture) {
    const Eigen::AlignedBox3d box = box_of(picture);
    const bool near = !picture.whole && !box.isEmpty();
    Sight sight = sight_;
    if (near) {
        sight.focus = box.center();
        sight.field = std::max(least_field * sight_.field, room_about_marks * box.diagonal().norm());
    }
    if (near || picture.whole) sight.view_angle_deg = thumbnail_angle_deg;
    vtkCamera* camera = renderer_->GetActiveCamera();
    look_from(camera, sight);
    if (picture.whole) {
        renderer_->ResetCamera();
        camera->Zoom(whole_zoom);
        return;
    }
    renderer_->ResetCameraClippingRange();
    if (!sight.blocked && !(near && sight.inside)) return;
    // What stands between the eye and the nearest of the marks is cut away, as in the window.
    double depth = depth_of(camera, near ? sight.focus : sight.target);
    for (const LessonMark& mark : picture.marks) depth = std::min(depth, depth_of(camera, mark.place));
    clip_before(camera, depth - cut_before_marks * sight.field);
}

}  // namespace palpate::visual
