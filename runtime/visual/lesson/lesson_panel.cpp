// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/lesson/lesson_panel.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <sstream>
#include <vtkAxis.h>
#include <vtkContextScene.h>
#include <vtkDoubleArray.h>
#include <vtkFloatArray.h>
#include <vtkPen.h>
#include <vtkPlot.h>
#include <vtkPlotPoints.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper2D.h>
#include <vtkTable.h>
#include <vtkTextProperty.h>
#include <vtkTexture.h>
#include <vtkTexturedActor2D.h>

#include "runtime/visual/overlay.hpp"
#include "runtime/visual/quads.hpp"
#include "runtime/visual/screen_text.hpp"

namespace palpate::visual {
namespace {

// Pixels in a window of 1280x720, see display_scale().
constexpr double page_height = 520, page_margin = 28, row_height = 30;  // the first is the least
constexpr double title_height = 44, line_height = 22, figure_height = 20;
constexpr double card_height = 74, card_share = 0.64;  // of a picture: how large it is on a card
constexpr std::size_t card_letters = 28;
constexpr double text_width = 640, chart_width = 420;  // a page has charts beside its text, or none
constexpr double edge = 20;                            // of the window, left free below and beside a page
constexpr double band_width = 320, band_height = 12;

int font(double size, double scale) {
    return std::max(9, static_cast<int>(size * scale));
}

void make_text(vtkTextActor* actor, bool centred, vtkRenderer* renderer) {
    vtkTextProperty* text = actor->GetTextProperty();
    dress(text, 0);
    text->SetLineSpacing(1.3);
    text->SetVerticalJustificationToTop();
    if (centred) text->SetJustificationToCentered();
    actor->VisibilityOff();
    renderer->AddActor2D(actor);
}

void set_text(vtkTextActor* actor, const std::string& text, double x, double y, int size) {
    actor->SetInput(text.c_str());
    actor->SetPosition(x, y);
    actor->GetTextProperty()->SetFontSize(size);
    actor->SetVisibility(!text.empty());
}

void paint(vtkTextProperty* text, int size) {
    text->SetColor(0.85, 0.88, 0.92);
    text->SetFontSize(size);
    text->SetBold(0);
}

// From 0 to `most` times `room`, with ticks at 1, 2 or 5 times a power of ten, five at most: VTK's own come
// by pixels, and crowd in a large window.
void show_from_zero(vtkAxis* axis, double most, double room, double least_step) {
    if (most <= 0) most = 1;
    const double power = std::pow(10, std::floor(std::log10(most / 5)));
    double step = power;
    for (const double factor : {2.0, 5.0, 10.0})
        if (most / step > 5) step = factor * power;
    step = std::max(step, least_step);
    vtkNew<vtkDoubleArray> ticks;
    for (double tick = 0; tick <= most * 1.001; tick += step) ticks->InsertNextValue(tick);
    axis->SetCustomTickPositions(ticks);
    axis->SetBehavior(vtkAxis::FIXED);
    axis->SetRange(0, room * most);
}

vtkSmartPointer<vtkContextActor> chart_of(const LessonCurve& curve, double left, double bottom, double width,
                                          double height, int font_size, vtkRenderer* renderer) {
    vtkNew<vtkDoubleArray> x, y;
    x->SetName("x");
    y->SetName("y");
    for (const double value : curve.x) x->InsertNextValue(value);
    for (const double value : curve.y) y->InsertNextValue(value);
    vtkNew<vtkTable> table;
    table->AddColumn(x);
    table->AddColumn(y);
    vtkNew<vtkChartXY> chart;
    chart->SetAutoSize(false);
    chart->SetSize(vtkRectf(static_cast<float>(left), static_cast<float>(bottom), static_cast<float>(width),
                            static_cast<float>(height)));
    chart->SetTitle(curve.title);
    paint(chart->GetTitleProperties(), font_size);
    for (const auto& [axis, title] :
         {std::pair(vtkAxis::BOTTOM, curve.x_title), {vtkAxis::LEFT, curve.y_title}}) {
        vtkAxis* a = chart->GetAxis(axis);
        a->SetTitle(title);
        paint(a->GetTitleProperties(), font_size);
        paint(a->GetLabelProperties(), font_size);
        a->SetNotation(vtkAxis::PRINTF_NOTATION);
        a->SetLabelFormat("%g");
        a->GetPen()->SetColor(140, 150, 160);
        a->GetGridPen()->SetColor(50, 58, 66);
    }
    vtkPlot* plot = chart->AddPlot(curve.points ? vtkChart::POINTS : vtkChart::LINE);
    plot->SetInputData(table, 0, 1);
    plot->SetColor(150, 220, 255, 255);
    plot->SetWidth(static_cast<float>(font_size) / 6);
    if (auto* points = vtkPlotPoints::SafeDownCast(plot))
        points->SetMarkerSize(static_cast<float>(font_size) / 2);
    if (curve.limit && !curve.x.empty()) {
        vtkNew<vtkDoubleArray> ends, limit;
        ends->SetName("x");
        limit->SetName("limit");
        for (const double end : {curve.x.front(), curve.x.back()}) {
            ends->InsertNextValue(end);
            limit->InsertNextValue(*curve.limit);
        }
        vtkNew<vtkTable> line;
        line->AddColumn(ends);
        line->AddColumn(limit);
        vtkPlot* limit_plot = chart->AddPlot(vtkChart::LINE);
        limit_plot->SetInputData(line, 0, 1);
        limit_plot->SetColor(255, 165, 60, 255);
        limit_plot->SetWidth(static_cast<float>(font_size) / 6);
    }
    const auto largest = [](const std::vector<double>& values) {
        return values.empty() ? 0 : *std::ranges::max_element(values);
    };
    show_from_zero(chart->GetAxis(vtkAxis::BOTTOM),
                   curve.points ? static_cast<double>(curve.x.size()) + 1 : largest(curve.x), 1,
                   curve.points ? 1 : 0);
    // So that a point at the upper end is whole.
    show_from_zero(chart->GetAxis(vtkAxis::LEFT),
                   curve.most_y.value_or(std::max(largest(curve.y), curve.limit.value_or(0))), 1.05, 0);
    auto actor = vtkSmartPointer<vtkContextActor>::New();
    actor->GetScene()->AddItem(chart);
    renderer->AddActor2D(actor);
    actor->GetScene()->SetRenderer(renderer);
    return actor;
}

// Everything that a page shows, as one text.
std::string digest_of(const LessonPage& page, const Thumbnails& pictures, int width, int height) {
    const auto shown = [&](const std::optional<LessonPicture>& picture) {
        return picture ? static_cast<const void*>(pictures.picture_of(*picture)) : nullptr;
    };
    std::string text =
        fmt::format("{}x{}\n{}\n{}\n{}\n", width, height, page.title, page.text, shown(page.picture));
    for (const auto& [name, value] : page.rows) text += name + "\t" + value + "\n";
    for (const LessonChoice& choice : page.choices)
        text += fmt::format("{}\t{}\t{}\n", choice.key, choice.text, shown(choice.picture));
    for (const LessonCurve& curve : page.curves) text += fmt::format("{} {}\n", curve.title, curve.x.size());
    return text;
}

std::size_t card_count(const LessonPage& page) {
    return static_cast<std::size_t>(std::ranges::count_if(
        page.choices, [](const LessonChoice& choice) { return choice.picture.has_value(); }));
}

// Of title, text and picture, in pixels of a window of 1280x720.
double head_height(const LessonPage& page) {
    double height = title_height;
    if (!page.text.empty())
        height += line_height * static_cast<double>(1 + std::ranges::count(page.text, '\n')) + 12;
    return page.picture ? std::max(height, Thumbnails::height + 16.0) : height;
}

// How wide what stands beside a page's curves is, in the same.
double text_part(const LessonPage& page) {
    const double beside = page.picture ? Thumbnails::width + 14.0 : 0;
    return page.rows.empty() ? text_width + beside : text_width - 220;
}

// In the same.
struct PageSize {
    double width, height;
};

PageSize size_of(const LessonPage& page) {
    const std::size_t cards = card_count(page), card_rows = (cards + 1) / 2;
    const double height = 2 * page_margin + head_height(page) +
                          figure_height * static_cast<double>(page.rows.size()) +
                          card_height * static_cast<double>(card_rows) +
                          row_height * static_cast<double>(page.choices.size() - cards);
    return {page.curves.empty() ? text_part(page) : text_part(page) + chart_width,
            cards > 0 ? height : std::max(page_height, height)};
}

// In lines of so many letters.
std::string wrapped(const std::string& text, std::size_t letters) {
    std::string lines;
    std::size_t used = 0;
    std::istringstream words(text);
    for (std::string word; words >> word; used += word.size() + 1) {
        if (used > 0 && used + word.size() > letters) used = 0;
        lines += (lines.empty() ? "" : used == 0 ? "\n" : " ") + word;
    }
    return lines;
}

}  // namespace

LessonPanel::LessonPanel(vtkRenderer* renderer) : renderer_(renderer) {
    make_quads(sheet_, sheet_points_, Rgb(10, 14, 18), 0.88, renderer);
    make_quads(below_, below_points_, Rgb(115, 122, 133), 0.8, renderer);
    make_quads(within_, within_points_, Rgb(89, 178, 242), 0.9, renderer);
    make_quads(above_, above_points_, Rgb(242, 140, 38), 0.9, renderer);
    make_quads(pointer_, pointer_points_, Rgb(255, 255, 255), 1, renderer);
    for (vtkTextActor* actor : {instruction_.Get(), status_.Get(), warning_.Get()})
        make_text(actor, true, renderer);
    for (vtkTextActor* actor : {instruction_.Get(), status_.Get(), warning_.Get()}) {
        actor->GetTextProperty()->SetBackgroundOpacity(0.6);
    }
    warning_->GetTextProperty()->SetColor(1, 0.72, 0.3);
    for (vtkTextActor* actor : {title_.Get(), text_.Get(), names_.Get(), values_.Get()})
        make_text(actor, false, renderer);
    title_->GetTextProperty()->BoldOn();
    names_->GetTextProperty()->SetColor(0.65, 0.70, 0.76);
}

void LessonPanel::update(const LessonView& view, const Thumbnails& pictures, double force, int width,
                         int height) {
    const double scale = display_scale(width, height), middle = width / 2.0;
    set_text(instruction_, view.instruction, middle, height - 14 * scale, font(18, scale));
    set_text(status_, view.status, middle, height - 46 * scale, font(18, scale));
    set_text(warning_, view.warning, middle, height - 104 * scale, font(20, scale));
    show_band(view, force, width, height);
    if (view.page)
        show_page(*view.page, pictures, width, height);
    else
        hide_page();
}

void LessonPanel::show_band(const LessonView& view, double force, int width, int height) {
    const bool on = view.most_force > 0;
    for (vtkActor2D* actor : {below_.Get(), within_.Get(), above_.Get(), pointer_.Get()})
        actor->SetVisibility(on);
    if (!on) return;
    const double scale = display_scale(width, height);
    const double left = width / 2.0 - scale * band_width / 2, whole = scale * band_width;
    const double top = height - 82 * scale, bottom = top - scale * band_height;
    // The band's upper end lies at two thirds of its width, whatever the force.
    const auto at = [&](double newtons) {
        return left + whole * std::min(1.0, newtons / (1.5 * view.most_force));
    };
    set_quad(below_points_, 0, left, bottom, at(view.least_force), top);
    set_quad(within_points_, 0, at(view.least_force), bottom, at(view.most_force), top);
    set_quad(above_points_, 0, at(view.most_force), bottom, left + whole, top);
    set_quad(pointer_points_, 0, at(force) - 2 * scale, bottom - 5 * scale, at(force) + 2 * scale,
             top + 5 * scale);
}

void LessonPanel::hide_page() {
    if (shown_.empty()) return;
    shown_.clear();
    sheet_->VisibilityOff();
    for (vtkTextActor* actor : {title_.Get(), text_.Get(), names_.Get(), values_.Get()})
        actor->VisibilityOff();
    for (const auto& choice : choices_) renderer_->RemoveActor2D(choice);
    for (const auto& chart : charts_) renderer_->RemoveActor2D(chart);
    for (const auto& picture : pictures_) renderer_->RemoveActor2D(picture);
    pictures_.clear();
    choices_.clear();
    charts_.clear();
    keys_.clear();
    boxes_.clear();
}

void LessonPanel::show_page(const LessonPage& page, const Thumbnails& pictures, int width, int height) {
    const std::string digest = digest_of(page, pictures, width, height);
    if (digest == shown_) return;
    hide_page();
    shown_ = digest;
    const PageSize size = size_of(page);
    const double outside = 2 * edge * display_scale(width, height);
    const double scale = std::min(
        {display_scale(width, height), (width - outside) / size.width, (height - outside) / size.height});
    const double margin = scale * page_margin, left = scale * edge, bottom = scale * edge;
    const double right = left + scale * size.width, top = bottom + scale * size.height;
    set_quad(sheet_points_, 0, left, bottom, right, top);
    sheet_->VisibilityOn();
    set_text(title_, page.title, left + margin, top - margin, font(26, scale));
    set_text(text_, page.text, left + margin, top - margin - scale * title_height, font(16, scale));
    if (page.picture)
        show_picture(pictures.picture_of(*page.picture), right - margin - scale * Thumbnails::width,
                     top - margin - scale * Thumbnails::height, scale);

    const double y = top - margin - scale * head_height(page);
    std::string names, values;
    for (const auto& [name, value] : page.rows) {
        names += (names.empty() ? "" : "\n") + name;
        values += (values.empty() ? "" : "\n") + value;
    }
    set_text(names_, names, left + margin, y, font(15, scale));
    set_text(values_, values, left + margin + 190 * scale, y, font(15, scale));

    const double chart_left = left + scale * text_part(page), chart_height = 220 * scale;
    for (std::size_t i = 0; i < page.curves.size(); ++i)
        charts_.push_back(
            chart_of(page.curves[i], chart_left, top - margin - static_cast<double>(i + 1) * chart_height,
                     right - margin - chart_left, chart_height - 8 * scale, font(12, scale), renderer_));

    const std::size_t cards = card_count(page);
    const double card_width = (right - left - 2 * margin) / 2;
    double choice_top =
        bottom + margin + scale * row_height * static_cast<double>(page.choices.size() - cards);
    std::size_t card = 0;
    for (const LessonChoice& choice : page.choices) {
        if (choice.picture) {
            const Box box = card_box(card++, left + margin, y, card_width, scale * card_height);
            const double picture_bottom = box.bottom + scale * 8;
            show_picture(pictures.picture_of(*choice.picture), box.left, picture_bottom, scale * card_share);
            show_choice(choice, wrapped(choice.text, card_letters),
                        box.left + scale * (card_share * Thumbnails::width + 14),
                        picture_bottom + scale * card_share * Thumbnails::height, scale, box);
        } else {
            show_choice(choice, choice.text, left + margin, choice_top, scale,
                        {left, choice_top - scale * row_height, right, choice_top});
            choice_top -= scale * row_height;
        }
    }
}

// Cards stand two in a row, from `top` down.
LessonPanel::Box LessonPanel::card_box(std::size_t card, double left, double top, double width,
                                       double height) {
    const std::size_t row = card / 2, column = card % 2;
    const double x = left + width * static_cast<double>(column), y = top - height * static_cast<double>(row);
    return {x, y - height, x + width, y};
}

void LessonPanel::show_choice(const LessonChoice& choice, const std::string& text, double x, double y,
                              double scale, const Box& box) {
    vtkNew<vtkTextActor> line;
    make_text(line, false, renderer_);
    line->GetTextProperty()->SetColor(1, 0.84, 0.35);
    set_text(line, text, x, y, font(17, scale));
    choices_.emplace_back(line);
    keys_.push_back(choice.key);
    boxes_.push_back(box);
}

void LessonPanel::show_picture(vtkImageData* pixels, double left, double bottom, double scale) {
    if (pixels == nullptr) return;
    vtkNew<vtkPoints> corners;
    vtkNew<vtkTexturedActor2D> picture;
    make_quads(picture, corners, Rgb(255, 255, 255), 1, renderer_);
    set_quad(corners, 0, left, bottom, left + scale * Thumbnails::width, bottom + scale * Thumbnails::height);
    vtkNew<vtkFloatArray> places;  // in the picture
    places->SetNumberOfComponents(2);
    for (const auto& [x, y] : {std::pair(0, 0), {1, 0}, {1, 1}, {0, 1}}) places->InsertNextTuple2(x, y);
    vtkPolyDataMapper2D::SafeDownCast(picture->GetMapper())->GetInput()->GetPointData()->SetTCoords(places);
    vtkNew<vtkTexture> texture;
    texture->SetInputData(pixels);
    texture->InterpolateOn();
    picture->SetTexture(texture);
    picture->VisibilityOn();
    pictures_.emplace_back(picture);
}

std::string LessonPanel::choice_at(int x, int y) const {
    for (std::size_t i = 0; i < boxes_.size(); ++i)
        if (x >= boxes_[i].left && x <= boxes_[i].right && y >= boxes_[i].bottom && y < boxes_[i].top)
            return keys_[i];
    return "";
}

bool LessonPanel::covers(int x, int y) const {
    double box[6];
    sheet_points_->GetBounds(box);
    return sheet_->GetVisibility() && x >= box[0] && x <= box[1] && y >= box[2] && y <= box[3];
}

void LessonPanel::hover(int x, int y) {
    const std::string key = choice_at(x, y);
    for (std::size_t i = 0; i < choices_.size(); ++i)
        choices_[i]->GetTextProperty()->SetColor(1, keys_[i] == key ? 1 : 0.84, keys_[i] == key ? 1 : 0.35);
}

}  // namespace palpate::visual
