// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/controls/button_bar.hpp"

#include <algorithm>
#include <cctype>
#include <fmt/format.h>
#include <vtkTextProperty.h>

#include "runtime/texts/translated.hpp"
#include "runtime/visual/controls/window_keys.hpp"
#include "runtime/visual/overlay.hpp"

namespace palpate::visual {
namespace {

// Pixels in a window of 1280x720, see display_scale().
constexpr double bar_edge = 22, bar_bottom = 18, button_height = 24, button_gap = 6, button_font = 14;

void dress(vtkTextActor* actor, vtkRenderer* renderer) {
    vtkTextProperty* text = actor->GetTextProperty();
    text->SetFontFamilyToArial();
    text->SetVerticalJustificationToCentered();
    text->SetBackgroundOpacity(0.75);
    actor->VisibilityOff();
    renderer->AddActor2D(actor);
}

}  // namespace

ButtonBar::ButtonBar(vtkRenderer* renderer, bool has_jaws) : renderer_(renderer) {
    for (const WindowKey& entry : window_keys()) {
        if (entry.of_jaws && !has_jaws) continue;
        Button button{entry.key, texts::looked_up(entry.tip), vtkSmartPointer<vtkTextActor>::New()};
        const char letter = static_cast<char>(std::toupper(static_cast<unsigned char>(entry.key.front())));
        // Blanks are the button's margin: a text's background ends with its letters.
        button.text->SetInput(fmt::format("  {}  {}  ", letter, texts::looked_up(entry.label)).c_str());
        dress(button.text, renderer);
        paint(button, false);
        buttons_.push_back(button);
    }
    dress(tip_, renderer);
    tip_->GetTextProperty()->SetColor(0.93, 0.95, 0.97);
    tip_->GetTextProperty()->SetBackgroundColor(0.05, 0.07, 0.09);
}

void ButtonBar::paint(const Button& button, bool under_pointer) {
    vtkTextProperty* text = button.text->GetTextProperty();
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

void ButtonBar::fit(int width, int height) {
    width_ = width;
    height_ = height;
    const double scale = display_scale(width, height);
    top_ = scale * (bar_bottom + button_height);
    double left = scale * bar_edge;
    for (Button& button : buttons_) {
        button.text->GetTextProperty()->SetFontSize(std::max(9, static_cast<int>(scale * button_font)));
        button.text->SetPosition(left, scale * (bar_bottom + button_height / 2));
        double box[4];
        button.text->GetBoundingBox(renderer_, box);
        button.left = left;
        button.right = left + box[1] - box[0];
        left = button.right + scale * button_gap;
    }
    tip_->GetTextProperty()->SetFontSize(std::max(9, static_cast<int>(scale * button_font)));
}

void ButtonBar::update(bool shown, int width, int height) {
    if (shown && (width != width_ || height != height_)) fit(width, height);
    if (shown == shown_) return;
    shown_ = shown;
    for (const Button& button : buttons_) button.text->SetVisibility(shown);
    if (!shown) tip_->VisibilityOff();
}

void ButtonBar::light(std::string_view key, bool on) {
    const auto button = std::ranges::find(buttons_, key, &Button::key);
    if (button == buttons_.end() || button->on == on) return;
    button->on = on;
    paint(*button, false);
}

std::string_view ButtonBar::key_at(int x, int y) const {
    if (!shown_ || y >= top_) return {};
    const auto button =
        std::ranges::find_if(buttons_, [&](const Button& b) { return x >= b.left && x <= b.right; });
    return button != buttons_.end() ? button->key : std::string_view();
}

void ButtonBar::hover(int x, int y) {
    const std::string_view key = key_at(x, y);
    tip_->SetVisibility(!key.empty());
    for (const Button& button : buttons_) {
        paint(button, button.key == key);
        if (button.key != key) continue;
        tip_->SetInput(fmt::format(" {} ", button.tip).c_str());
        tip_->SetPosition(button.left, 1.45 * top_);
    }
}

}  // namespace palpate::visual
