// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/overlay.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <vtkActor2D.h>
#include <vtkCoordinate.h>
#include <vtkPoints.h>
#include <vtkProperty2D.h>
#include <vtkRenderer.h>
#include <vtkTextActor.h>
#include <vtkTextProperty.h>
#include <vtkWindow.h>

#include "formats/records/fault.hpp"
#include "formats/records/shown_text.hpp"
#include "formats/records/tick_result.hpp"
#include "runtime/texts/translated.hpp"
#include "runtime/visual/cautions_text.hpp"
#include "runtime/visual/quads.hpp"
#include "runtime/visual/readings/force_colour.hpp"
#include "runtime/visual/readings/health.hpp"
#include "runtime/visual/screen_text.hpp"

namespace palpate::visual {
namespace {

using texts::looked_up;
using texts::translated;

// Pixels at 1280x720; the places of what is fixed to an edge are shares of the window.
constexpr double left_edge = 0.017, bar_bottom = 0.885;
constexpr double bar_width = 240, bar_height = 10, strip_height = 44, gap = 8, light_size = 11;
constexpr int small_font = 13;
constexpr auto help_text = shown_text(
    "left button  press      held, wheel or W S  deeper, back      W S, arrows  move the tool\n"
    "right drag  turn      middle drag  move the view      wheel, + -  zoom");
constexpr auto forceps_help_text = shown_text(
    "left drag  carry the forceps      W S  in, out      arrows  move it      J  close the jaws, open them\n"
    "right drag  turn      middle drag  move the view      wheel, + -  zoom");
constexpr auto turning_help_text =
    shown_text("Shift + arrows, right drag  turn the tool      Shift + W S  roll it");
constexpr auto playback_help_text = shown_text(
    "Space  pause, go on      , .  slower, faster      arrows  step      Home, End      timeline  go there\n"
    "right drag  turn      middle drag  move the view      wheel, + -  zoom");
constexpr double help_opacity = 0.75;
constexpr double notice_top = 0.86, notice_top_played = 0.82;  // below the health of what is played
constexpr double above_buttons = 0.085, above_both_rows = 0.13, above_timeline = 0.21;  // of the height
constexpr std::size_t cautions_width = 64;                                              // characters

// Lines that start below each other, at the right of a window of any size.
void start_left_of_its_place(vtkTextActor* actor) {
    vtkNew<vtkCoordinate> right;
    right->SetCoordinateSystemToNormalizedViewport();
    right->SetValue(actor->GetPosition());
    actor->GetPositionCoordinate()->SetReferenceCoordinate(right);
    actor->GetPositionCoordinate()->SetCoordinateSystemToViewport();
}

void make_bar(vtkActor2D* actor, vtkPoints* points, double opacity, vtkRenderer* renderer) {
    make_quads(actor, points, Rgb(255, 255, 255), opacity, renderer);
    actor->GetPositionCoordinate()->SetCoordinateSystemToNormalizedViewport();
    actor->SetPosition(left_edge, bar_bottom);
    actor->VisibilityOn();
}

}  // namespace

std::string notice_of(const VisualFrame& frame) {
    std::string notice;
    for (const FaultText& text : fault_texts())
        if ((frame.faults & text.fault) && text.fault != servo_stopping)
            notice += (notice.empty() ? "" : "\n") +
                      translated("force taken away: {}", looked_up(text.cause)) + "\n" +
                      std::string(looked_up(text.remedy));
    for (const StatusText& text : status_texts())
        if (text.told && (frame.statuses & text.status))
            notice += fmt::format("{}{}", notice.empty() ? "" : "\n", looked_up(text.meaning));
    return notice;
}

std::string title_of(const std::string& case_name, const VisualFrame& frame) {
    if (frame.deforming_far.empty()) return case_name;
    std::string bodies;
    for (const std::string& name : frame.deforming_far) bodies += (bodies.empty() ? "" : ", ") + name;
    return translated("{}, large deformation: {}", case_name, bodies);
}

std::string figures_of(const VisualFrame& frame, double frames_per_second, const ShownDetail& detail) {
    const std::string torque =
        turns(frame) ? translated("torque {:.1f} N mm", frame.torque.norm()) + "\n" : "";
    const std::string level =
        detail.levels > 0 ? translated(", detail {} of {}", detail.level, detail.levels) : "";
    return translated("depth {:.1f} mm", std::max(0.0, frame.depth)) + "\n" + torque +
           translated("{:.0f} ticks/s, {} overruns\n{:.0f} frames/s{}", frame.tick_rate_hz, frame.overruns,
                      frames_per_second, level);
}

double display_scale(int width, int height) {
    constexpr double smallest = 0.7;
    return std::max(smallest, std::min(width / 1280.0, height / 720.0));
}

Overlay::Overlay(const std::string& case_name, double max_force, std::span<const std::string> cautions,
                 bool turns_tool, vtkRenderer* renderer)
    : case_name_(case_name),
      renderer_(renderer),
      max_force_(max_force),
      turns_tool_(turns_tool),
      strip_(renderer) {
    make_bar(bar_frame_, whole_bar_points_, 0.3, renderer);
    make_bar(bar_, bar_points_, 1, renderer);
    make_quads(light_, light_points_, health_colour(Health::good), 1, renderer);
    light_->VisibilityOn();
    place(force_, left_edge, 0.975, 30, false, true);
    place(most_force_, left_edge, bar_bottom, small_font, false, false);
    most_force_->SetInput(fmt::format("{:g} N", max_force).c_str());
    place(health_, left_edge, bar_bottom, 14, false, true);
    place(figures_, left_edge, bar_bottom, 16, false, true);
    place(title_, 0.983, 0.975, 18, true, true);
    place(help_, left_edge, above_buttons, 14, false, false);
    place(told_, 0.983, above_buttons, 16, true, false);
    place(notice_, 0.5, notice_top, 20, false, true);
    notice_->GetTextProperty()->SetJustificationToCentered();
    notice_->GetTextProperty()->SetColor(1, 0.75, 0.3);
    place(cautions_, 0.983, 0.92, 14, false, true);
    start_left_of_its_place(cautions_);
    title_->SetInput(case_name.c_str());
    const std::string text = cautions_text(cautions, cautions_width);
    cautions_->SetInput(
        (text.empty() ? translated("nothing is noted about how this case was made") : text).c_str());
    cautions_shown_ = !text.empty();
    show_texts();
    help_->GetTextProperty()->SetOpacity(help_opacity);
}

void Overlay::place(vtkTextActor* actor, double x, double y, int size, bool right, bool top) {
    actor->GetPositionCoordinate()->SetCoordinateSystemToNormalizedViewport();
    actor->SetPosition(x, y);
    vtkTextProperty* text = actor->GetTextProperty();
    dress(text, 0.55);
    text->SetLineSpacing(1.25);
    if (right) text->SetJustificationToRight();
    if (top) text->SetVerticalJustificationToTop();
    texts_.push_back({actor, size});
    renderer_->AddActor2D(actor);
}

void Overlay::fit_window() {
    const int* size = renderer_->GetVTKWindow()->GetSize();
    const double scale = display_scale(size[0], size[1]);
    if (scale == scale_) return;
    scale_ = scale;
    for (const SizedText& text : texts_)
        text.actor->GetTextProperty()->SetFontSize(static_cast<int>(std::lround(scale * text.size)));
    double wide[2];  // and high, pixels
    cautions_->GetSize(renderer_, wide);
    cautions_->SetPosition(-wide[0], 0);
    set_quad(whole_bar_points_, 0, 0, 0, scale * bar_width, scale * bar_height);
}

// Below the number, from the bar down: the last seconds, the light, the figures; nothing below a page.
void Overlay::show_readings(bool with_strip) {
    const int* size = renderer_->GetVTKWindow()->GetSize();
    const int width = size[0], height = size[1];
    const double left = left_edge * width, bar = bar_bottom * height;
    most_force_->SetPosition((left + scale_ * (bar_width + gap)) / width, bar_bottom);
    const double strip_bottom = bar - scale_ * (gap + strip_height);
    strip_.place({left, strip_bottom, scale_ * bar_width, scale_ * strip_height},
                 static_cast<int>(std::lround(scale_ * small_font)));
    strip_.show(with_strip && !page_shown_);
    for (vtkActor2D* part : {bar_.Get(), bar_frame_.Get(), light_.Get()}) part->SetVisibility(!page_shown_);
    for (vtkTextActor* text : {most_force_.Get(), health_.Get(), figures_.Get()})
        text->SetVisibility(!page_shown_);
    const double light_top = (with_strip ? strip_bottom : bar) - scale_ * 1.5 * gap;
    set_quad(light_points_, 0, left, light_top - scale_ * light_size, left + scale_ * light_size, light_top);
    health_->SetPosition((left + scale_ * (light_size + gap)) / width, (light_top + scale_ * 2) / height);
    figures_->SetPosition(left_edge, (light_top - scale_ * (light_size + gap)) / height);
}

void Overlay::update(const VisualFrame& frame, double frames_per_second, const ShownDetail& detail) {
    using namespace std::chrono_literals;
    fit_window();
    const double newtons = frame.force.norm();
    if (newtons > 0 && !was_touched_) {
        was_touched_ = true;
        cautions_shown_ = false;
        show_texts();
    }
    const double share = std::min(1.0, newtons / max_force_);
    set_quad(bar_points_, 0, 0, 0, scale_ * bar_width * share, scale_ * bar_height);
    set_colour(bar_, force_colour(share));
    const auto now = std::chrono::steady_clock::now();
    strip_.add(now, frame.force_range);
    filmed_ = frame.film_rate_hz.has_value();
    if (now - last_ < 200ms && !filmed_) return;
    fade_help(now);
    last_ = now;
    show_readings(!frame.timeline);
    told_->SetVisibility(now < told_until_);
    const auto hints = frame.timeline      ? playback_help_text
                       : frame.jaws_closed ? forceps_help_text
                                           : help_text;
    std::string help(looked_up(hints));
    if (turns_tool_ && !frame.timeline) help += "\n" + std::string(looked_up(turning_help_text));
    help_->SetInput(help.c_str());
    notice_->SetPosition(0.5, frame.timeline ? notice_top_played : notice_top);
    const double low = frame.timeline ? above_timeline : button_rows_ > 1 ? above_both_rows : above_buttons;
    for (vtkTextActor* text : {help_.Get(), told_.Get()}) text->SetPosition(text->GetPosition()[0], low);
    force_->SetInput(fmt::format("{:.2f} N", newtons).c_str());
    figures_->SetInput(figures_of(frame, frames_per_second, detail).c_str());
    health_->SetInput(health_text(frame).c_str());
    set_colour(light_, health_colour(health_of(frame)));
    notice_->SetInput(notice_of(frame).c_str());
    title_->SetInput(title_of(case_name_, frame).c_str());
}

void Overlay::tell(const std::string& sentence) {
    told_->SetInput(sentence.c_str());
    told_->VisibilityOn();
    told_until_ = std::chrono::steady_clock::now() + std::chrono::seconds(4);
}

void Overlay::turn_help() {
    help_shown_ = !help_shown_;
    help_fades_ = false;
    help_->GetTextProperty()->SetOpacity(help_opacity);
    show_texts();
}

// Once it has been over the scene for long enough to be read.
void Overlay::fade_help(std::chrono::steady_clock::time_point now) {
    using Seconds = std::chrono::duration<double>;
    constexpr Seconds whole(25), fading(4);
    if (!help_fades_ || !help_shown_ || page_shown_ || last_ == decltype(last_){}) return;
    help_seen_ += now - last_;
    const double share = std::clamp((whole + fading - Seconds(help_seen_)) / fading, 0.0, 1.0);
    help_->GetTextProperty()->SetOpacity(help_opacity * share);
    help_shown_ = share > 0;
    show_texts();
}

void Overlay::turn_cautions() {
    cautions_shown_ = !cautions_shown_;
    show_texts();
}

void Overlay::make_room(bool for_page, bool for_exercise, int button_rows) {
    button_rows_ = button_rows;
    page_shown_ = for_page;
    exercise_shown_ = for_exercise;
    show_texts();
}

void Overlay::show_texts() {
    help_->SetVisibility(help_shown_ && !page_shown_ && !filmed_);
    cautions_->SetVisibility(cautions_shown_ && !page_shown_ && !exercise_shown_);
}

}  // namespace palpate::visual
