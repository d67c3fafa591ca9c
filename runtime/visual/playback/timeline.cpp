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

namespace palpate::visual {

Timeline::Timeline(vtkRenderer* renderer, vtkRenderWindowInteractor* interactor)
    : renderer_(renderer), interactor_(interactor) {
    make_quads(band_, band_points_, Rgb(13, 18, 23), 0.7, renderer);
    make_quads(curve_, curve_points_, Rgb(115, 199, 255), 1, renderer);
    make_quads(head_, head_points_, Rgb(255, 217, 76), 1, renderer);
    vtkTextProperty* text = text_->GetTextProperty();
    text->SetFontFamilyToArial();
    text->SetColor(0.93, 0.95, 0.97);
    text->SetBackgroundColor(0.05, 0.07, 0.09);
    text->SetBackgroundOpacity(0.7);
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
    const bool inside =
        shown_ && at[0] >= left_ && at[0] <= left_ + width_ && at[1] >= bottom_ && at[1] <= bottom_ + height_;
    if (event == vtkCommand::LeftButtonPressEvent) dragged_ = inside;
    events_->SetAbortFlag(dragged_);
    if (!dragged_) return;
    sought_ = std::clamp((at[0] - left_) / width_, 0.0, 1.0);
    if (event == vtkCommand::LeftButtonReleaseEvent) dragged_ = false;
}

std::optional<double> Timeline::take_sought() {
    return std::exchange(sought_, std::nullopt);
}

void Timeline::lay_out() {
    constexpr double margin = 0.017;                               // of the window's width
    constexpr double height = 56, below = 52, gap = 6, font = 15;  // pixels at 1280x720
    const double scale = display_scale(window_[0], window_[1]);
    left_ = margin * window_[0];
    width_ = std::max(1.0, window_[0] - 2 * left_);
    bottom_ = scale * below;
    height_ = scale * height;
    set_quad(band_points_, 0, left_, bottom_, left_ + width_, bottom_ + height_);
    text_->SetPosition(left_, bottom_ + height_ + scale * gap);
    text_->GetTextProperty()->SetFontSize(static_cast<int>(std::lround(scale * font)));
}

// A column reaches from its least to its largest force, and up to the next one's, so that a line is whole.
void Timeline::draw_curve() {
    constexpr double headroom = 0.92, thinnest = 1.5;  // of the band; pixels
    double most = 0;
    for (const Eigen::Vector2d& column : forces_) most = std::max(most, column[1]);
    const double pixels = most > 0 ? headroom * height_ / most : 0;
    const double step = width_ / static_cast<double>(std::max<std::size_t>(1, forces_.size()));
    set_quad_count(curve_, curve_points_, static_cast<vtkIdType>(forces_.size()));
    for (std::size_t i = 0; i < forces_.size(); ++i) {
        const Eigen::Vector2d& next = forces_[std::min(i + 1, forces_.size() - 1)];
        const double low = std::min(forces_[i][0], next[1]), high = std::max(forces_[i][1], next[0]);
        const double left = left_ + step * static_cast<double>(i);
        set_quad(curve_points_, static_cast<vtkIdType>(i), left, bottom_ + pixels * low, left + step,
                 bottom_ + std::max(pixels * high, pixels * low + thinnest));
    }
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
    const double half = std::max(1.0, 0.02 * height_), at = left_ + view->share * width_;
    set_quad(head_points_, 0, at - half, bottom_, at + half, bottom_ + height_);
    text_->SetInput(view->text.c_str());
}

}  // namespace palpate::visual
