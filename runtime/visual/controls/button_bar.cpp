// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/controls/button_bar.hpp"

#include <algorithm>
#include <cctype>
#include <fmt/format.h>
#include <utility>
#include <vtkTextProperty.h>

#include "runtime/texts/translated.hpp"
#include "runtime/visual/controls/window_keys.hpp"
#include "runtime/visual/overlay.hpp"
#include "runtime/visual/screen_text.hpp"

namespace palpate::visual {
namespace {

// Pixels in a window of 1280x720, see display_scale().
constexpr double bar_edge = 22, bar_bottom = 18, button_height = 24, button_gap = 6, button_font = 14;
constexpr int least_font = 6;

void make_button(vtkTextActor* actor, double opacity, vtkRenderer* renderer) {
    dress(actor->GetTextProperty(), opacity);
    actor->GetTextProperty()->SetVerticalJustificationToCentered();
    actor->VisibilityOff();
    renderer->AddActor2D(actor);
}

}  // namespace

std::vector<ButtonText> window_buttons(bool has_jaws) {
    std::vector<ButtonText> buttons;
    for (const WindowKey& entry : window_keys()) {
        if (entry.of_jaws && !has_jaws) continue;
        const char letter = static_cast<char>(std::toupper(static_cast<unsigned char>(entry.key.front())));
        buttons.push_back({std::string(entry.key),
                           fmt::format("{}  {}", letter, texts::looked_up(entry.label)),
                           std::string(texts::looked_up(entry.tip))});
    }
    return buttons;
}

ButtonBar::ButtonBar(vtkRenderer* renderer, int row) : renderer_(renderer), row_(row) {
    make_button(tip_, 0.95, renderer);
}

void ButtonBar::move_to(int row) {
    if (std::exchange(row_, row) != row) width_ = 0;  // to be made anew
}

void ButtonBar::set(const std::vector<ButtonText>& buttons) {
    if (buttons == texts_) return;
    texts_ = buttons;
    for (const Button& button : buttons_) renderer_->RemoveActor2D(button.actor);
    buttons_.clear();
    for (const ButtonText& text : buttons) {
        Button button{text, vtkSmartPointer<vtkTextActor>::New()};
        // Blanks are the button's margin: a text's background ends with its letters.
        button.actor->SetInput(fmt::format("  {}  ", text.text).c_str());
        make_button(button.actor, 0.75, renderer_);
        button.actor->SetVisibility(shown_);
        paint(button, false);
        buttons_.push_back(button);
    }
    if (shown_)
        fit(width_, height_);
    else
        width_ = 0;  // to be made when it is shown
}

void ButtonBar::paint(const Button& button, bool under_pointer) {
    vtkTextProperty* text = button.actor->GetTextProperty();
    // Told apart by lightness, for eyes that do not tell colours apart.
    if (button.on) {
        text->SetColor(0.05, 0.07, 0.09);
        text->SetBackgroundColor(0.62, 0.78, 0.90);
    } else {
        text->SetColor(0.93, 0.95, 0.97);
        text->SetBackgroundColor(0.16, 0.20, 0.25);
    }
    if (under_pointer) text->SetBackgroundColor(0.98, 0.80, 0.30);
    if (under_pointer) text->SetColor(0.05, 0.07, 0.09);
}

// Some languages say things at greater length: their buttons are written smaller.
void ButtonBar::fit(int width, int height) {
    width_ = width;
    height_ = height;
    const double scale = display_scale(width, height);
    bottom_ = scale * (bar_bottom + row_ * (button_height + button_gap));
    top_ = bottom_ + scale * button_height;
    int font = std::max(9, static_cast<int>(scale * button_font));
    tip_->GetTextProperty()->SetFontSize(font);
    while (lay_out(font, scale) > width - scale * bar_edge && font > least_font) --font;
}

// Returns where the last one ends.
double ButtonBar::lay_out(int font, double scale) {
    double left = scale * bar_edge;
    for (Button& button : buttons_) {
        button.actor->GetTextProperty()->SetFontSize(font);
        button.actor->SetPosition(left, (bottom_ + top_) / 2);
        double box[4];
        button.actor->GetBoundingBox(renderer_, box);
        button.left = left;
        button.right = left + box[1] - box[0];
        left = button.right + scale * button_gap;
    }
    return buttons_.empty() ? 0 : buttons_.back().right;
}

void ButtonBar::update(bool shown, int width, int height) {
    if (shown && (width != width_ || height != height_)) fit(width, height);
    if (shown == shown_) return;
    shown_ = shown;
    for (const Button& button : buttons_) button.actor->SetVisibility(shown);
    if (!shown) tip_->VisibilityOff();
}

void ButtonBar::light(std::string_view key, bool on) {
    const auto button = std::ranges::find_if(buttons_, [&](const Button& b) { return b.text.key == key; });
    if (button == buttons_.end() || button->on == on) return;
    button->on = on;
    paint(*button, false);
}

std::string ButtonBar::key_at(int x, int y) const {
    const bool inside = shown_ && y < top_ && (row_ == 0 || y >= bottom_);
    const auto button =
        std::ranges::find_if(buttons_, [&](const Button& b) { return x >= b.left && x <= b.right; });
    return inside && button != buttons_.end() ? button->text.key : "";
}

void ButtonBar::hover(int x, int y) {
    const std::string key = key_at(x, y);
    tip_->VisibilityOff();
    for (const Button& button : buttons_) {
        const bool under_pointer = button.text.key == key;
        paint(button, under_pointer);
        if (!under_pointer || button.text.tip.empty()) continue;
        tip_->SetInput(fmt::format(" {} ", button.text.tip).c_str());
        tip_->SetPosition(button.left, top_ + 0.8 * (top_ - bottom_));
        tip_->VisibilityOn();
        // What was added last is drawn over a row above.
        renderer_->RemoveActor2D(tip_);
        renderer_->AddActor2D(tip_);
    }
}

}  // namespace palpate::visual
