// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/readings/force_strip.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <vtkTextProperty.h>

#include "runtime/visual/quads.hpp"
#include "runtime/visual/screen_text.hpp"

namespace palpate::visual {
namespace {

constexpr std::chrono::milliseconds column_time(100);
constexpr std::size_t column_count = 100;
constexpr double headroom = 0.92;     // of the strip, that the largest force takes
constexpr double least_whole = 0.05;  // N, that the strip's height means at least: noise is not blown up

}  // namespace

ForceStrip::ForceStrip(vtkRenderer* renderer) : columns_(column_count, Eigen::Vector2d::Zero()) {
    make_quads(sheet_, sheet_points_, Rgb(13, 18, 23), 0.55, renderer);
    make_quads(curve_, curve_points_, Rgb(115, 199, 255), 1, renderer);
    dress(scale_->GetTextProperty(), 0.55);
    scale_->GetTextProperty()->SetVerticalJustificationToTop();
    renderer->AddActor2D(scale_);
    show(true);
}

void ForceStrip::add(Time now, const Eigen::Vector2d& range) {
    if (!began_) {
        began_ = now;
        latest_ = range;
    }
    latest_ = {std::min(latest_[0], range[0]), std::max(latest_[1], range[1])};
    const auto ended = std::min<std::ptrdiff_t>((now - *began_) / column_time, column_count);
    if (ended == 0) return;
    std::shift_left(columns_.begin(), columns_.end(), ended);
    std::fill(columns_.end() - ended, columns_.end(), latest_);
    began_ = std::max(*began_ + ended * column_time, now - column_time);
    latest_ = range;
    draw();
}

void ForceStrip::draw() {
    double most = 0;
    for (const Eigen::Vector2d& column : columns_) most = std::max(most, column[1]);
    draw_columns(curve_, curve_points_, columns_, std::max(most, least_whole) / headroom, box_);
    constexpr double seconds = std::chrono::duration<double>(column_time).count() * column_count;
    scale_->SetInput(fmt::format("{:.2f} N\n{:.0f} s", most, seconds).c_str());
}

void ForceStrip::place(const Box& box, int font) {
    if (box == box_) return;
    box_ = box;
    set_quad(sheet_points_, 0, box.left, box.bottom, box.left + box.width, box.bottom + box.height);
    scale_->SetPosition(box.left + box.width + font / 2.0, box.bottom + box.height);
    scale_->GetTextProperty()->SetFontSize(font);
    draw();
}

void ForceStrip::show(bool on) {
    sheet_->SetVisibility(on);
    curve_->SetVisibility(on);
    scale_->SetVisibility(on);
}

}  // namespace palpate::visual
