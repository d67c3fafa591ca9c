// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/playback/timeline.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vtkCommand.h>
#include <vtkRenderWindow.h>
#include <vtkTextProperty.h>

#include "runtime/visual/overlay.hpp"
#include "runtime/visual/quads.hpp"
#include "runtime/visual/readings/force_columns.hpp"
#include "runtime/visual/screen_text.hpp"

namespace palpate::visual {

Timeline::Timeline(vtkRenderer* renderer, vtkRenderWindowInteractor* interactor)
    : renderer_(renderer), interactor_(interactor) {
    make_quads(band_, band_points_, Rgb(13, 18, 23), 0.7, renderer);
    make_quads(curve_, curve_points_, Rgb(115, 199, 255), 1, renderer);
    make_quads(head_, head_points_, Rgb(255, 217, 76), 1, renderer);
    dress(text_->GetTextProperty(), 0.7);
    text_->VisibilityOff();
    renderer->AddActor2D(text_);
    events_->SetClientData(this);
    events_->SetCallback([](vtkObject*, unsigned long event, void* self, void*) {
        static_cast<Timeline*>(self)->handle(event);
    });
    constexpr float before_others = 1;
    for (const unsigned long event :
         {vtkCommand::LeftButtonPressEvent, vtkCommand::LeftButtonReleaseEvent, vtkCommand::MouseMoveEvent})
        interactor->AddObserver(event, events_, before_others);
}

void Timeline::handle(unsigned long event) {
    const int* at = interactor_->GetEventPosition();
    const bool inside = shown_ && at[0] >= box_.left && at[0] <= box_.left + box_.width &&
                        at[1] >= box_.bottom && at[1] <= box_.bottom + box_.height;
    if (event == vtkCommand::LeftButtonPressEvent) dragged_ = inside;
    events_->SetAbortFlag(dragged_);
    if (!dragged_) return;
    sought_ = std::clamp((at[0] - box_.left) / box_.width, 0.0, 1.0);
    if (event == vtkCommand::LeftButtonReleaseEvent) dragged_ = false;
}

std::optional<double> Timeline::take_sought() {
    return std::exchange(sought_, std::nullopt);
}

void Timeline::lay_out() {
    constexpr double margin = 0.017;                               // of the window's width
    constexpr double height = 56, below = 52, gap = 6, font = 15;  // pixels at 1280x720
    const double scale = display_scale(window_[0], window_[1]);
    const double left = margin * window_[0];
    box_ = {left, scale * below, std::max(1.0, window_[0] - 2 * left), scale * height};
    set_quad(band_points_, 0, box_.left, box_.bottom, box_.left + box_.width, box_.bottom + box_.height);
    text_->SetPosition(box_.left, box_.bottom + box_.height + scale * gap);
    text_->GetTextProperty()->SetFontSize(static_cast<int>(std::lround(scale * font)));
}

void Timeline::draw_curve() {
    constexpr double headroom = 0.92;  // of the band
    double most = 0;
    for (const Eigen::Vector2d& column : forces_) most = std::max(most, column[1]);
    draw_columns(curve_, curve_points_, forces_, most / headroom, box_);
}

void Timeline::update(const std::optional<TimelineView>& view) {
    shown_ = view.has_value();
    for (vtkActor2D* part : {static_cast<vtkActor2D*>(band_), static_cast<vtkActor2D*>(curve_),
                             static_cast<vtkActor2D*>(head_), static_cast<vtkActor2D*>(text_)})
        part->SetVisibility(shown_);
    if (!view) return;
    const int* size = renderer_->GetVTKWindow()->GetSize();
    const bool resized = size[0] != window_[0] || size[1] != window_[1];
    if (resized) {
        window_ = {size[0], size[1]};
        lay_out();
    }
    if (resized || view->forces != forces_) {
        forces_ = view->forces;
        draw_curve();
    }
    const double half = std::max(1.0, 0.02 * box_.height), at = box_.left + view->share * box_.width;
    set_quad(head_points_, 0, at - half, box_.bottom, at + half, box_.bottom + box_.height);
    text_->SetInput(view->text.c_str());
}

}  // namespace palpate::visual
