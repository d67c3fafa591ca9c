// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/seeds/legend.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <sstream>
#include <vtkTextProperty.h>

#include "tools/seeds/slice_pane.hpp"

namespace palpate::seeds {
namespace {

constexpr auto help_keys =
    "left click\nright click\nX,  U\n0 ... 9\nwheel, arrows\nshift + left, middle\nright drag\n+  -\n"
    "Z,  H\nS,  Q";
constexpr auto help_text =
    "place a seed\nremove the nearest seed\nremove the last seed, undo\nchoose the label\n"
    "scroll the slice under the pointer\nmove the crosshair only\ncontrast and brightness\n"
    "grey windows for other tissues\nzoom, hide this help\nsave, quit";

constexpr double edge = 16, help_indent = 170, help_height = 200;  // pixels
constexpr double character = 8;  // pixels, of a refusal's letters on average

// Breaks a text at blanks into lines of at most `width` characters, where words are no longer.
std::string wrapped(const std::string& text, std::size_t width) {
    std::istringstream words(text);
    std::string lines, line;
    for (std::string word; words >> word;) {
        if (!line.empty() && line.size() + 1 + word.size() > width) {
            lines += line + '\n';
            line.clear();
        }
        line += (line.empty() ? "" : " ") + word;
    }
    return lines + line;
}

std::string row_text(const SeedState& state, std::size_t number, const Growth* growth) {
    const std::string& label = state.labels[number];
    const auto seeds = std::ranges::count(state.seeds, label, &imaging::Seed::label);
    std::string text = fmt::format("{}   {} seed{}", label, seeds, seeds == 1 ? "" : "s");
    if (growth == nullptr) return text;
    const auto grown = std::ranges::find(growth->map.names, label, &palpate::Label::name);
    if (grown != growth->map.names.end())
        text += fmt::format("   {:.1f} ml", growth->volume_ml[grown - growth->map.names.begin()]);
    return text;
}

}  // namespace

Legend::Legend(const std::string& title, std::size_t labels) {
    for (vtkRenderer* renderer : {renderer_.Get(), status_renderer_.Get()})
        renderer->SetBackground(0.09, 0.11, 0.14);
    const auto add = [](vtkTextActor* actor, int size, vtkRenderer* renderer) {
        set_type(actor, size);
        renderer->AddActor2D(actor);
    };
    add(title_, 17, renderer_);
    title_->SetInput(title.c_str());
    title_->GetTextProperty()->SetVerticalJustificationToTop();
    for (std::size_t number = 0; number < labels; ++number) {
        Row row{vtkSmartPointer<vtkTextActor>::New(), vtkSmartPointer<vtkTextActor>::New()};
        add(row.key, 15, renderer_);
        add(row.text, 15, renderer_);
        const auto colour = label_colour(number);
        row.key->SetInput(fmt::format(" {} ", number).c_str());
        row.key->GetTextProperty()->BoldOn();
        row.key->GetTextProperty()->SetColor(0, 0, 0);
        row.key->GetTextProperty()->SetBackgroundColor(colour[0], colour[1], colour[2]);
        row.key->GetTextProperty()->SetBackgroundOpacity(1);
        rows_.push_back(row);
    }
    add(grey_, 14, renderer_);
    grey_->GetTextProperty()->SetColor(0.65, 0.72, 0.78);
    add(refused_, 14, renderer_);
    refused_->GetTextProperty()->SetColor(1, 0.62, 0.4);
    add(help_keys_, 14, renderer_);
    help_keys_->SetInput(help_keys);
    help_keys_->GetTextProperty()->BoldOn();
    add(help_, 14, renderer_);
    help_->SetInput(help_text);
    add(pointer_, 14, status_renderer_);
    add(message_, 14, status_renderer_);
    message_->GetTextProperty()->SetJustificationToRight();
    message_->GetTextProperty()->SetColor(1, 0.9, 0.6);
}

void Legend::update(const SeedState& state, const GreyPreset& grey, const Growth* growth) {
    for (std::size_t number = 0; number < rows_.size(); ++number) {
        const bool active = number == state.active;
        vtkTextProperty* type = rows_[number].text->GetTextProperty();
        type->SetBold(active);
        type->SetOpacity(active ? 1 : 0.7);
        rows_[number].text->SetInput((row_text(state, number, growth) + (active ? "   <" : "")).c_str());
    }
    grey_->SetInput(
        fmt::format("grey window: {}, width {:.0f}, level {:.0f}", grey.name, grey.width, grey.level)
            .c_str());
    refusal_ = growth == nullptr ? "" : growth->refused;
    show_help();
}

void Legend::toggle_help() {
    help_wanted_ = !help_wanted_;
    show_help();
}

// A refusal takes the help's place.
void Legend::show_help() {
    const auto characters = static_cast<std::size_t>(std::max(20.0, (width_ - 2 * edge) / character));
    refused_->SetInput(wrapped(refusal_, characters).c_str());
    const bool shown = help_wanted_ && refusal_.empty();
    help_->SetVisibility(shown);
    help_keys_->SetVisibility(shown);
}

void Legend::place(const Layout& layout, const Eigen::Vector2d& window_size) {
    set_viewport(renderer_, layout.legend, window_size);
    set_viewport(status_renderer_, layout.status, window_size);
    constexpr double title_height = 44, tallest_row = 30;
    constexpr std::size_t one_column = 5;  // labels that fit above the help on a small screen
    const Eigen::Vector2d size = layout.legend.size;
    title_->SetPosition(edge, size[1] - 14);
    const std::size_t columns = rows_.size() > one_column ? 2 : 1,
                      lines = (rows_.size() + columns - 1) / columns;
    const double room = size[1] - title_height - help_height - 20;
    const double row_height = std::min(tallest_row, room / static_cast<double>(lines + 1));
    const double top = size[1] - title_height - row_height;
    // Structures first, the background last.
    for (std::size_t n = 0; n < rows_.size(); ++n) {
        const Row& row = rows_[(n + 1) % rows_.size()];
        const std::size_t column = n / lines, line = n % lines;
        const double x = edge + static_cast<double>(column) * size[0] / 2,
                     y = top - static_cast<double>(line) * row_height;
        row.key->SetPosition(x, y);
        row.text->SetPosition(x + 34, y);
    }
    grey_->SetPosition(edge, top - static_cast<double>(lines) * row_height);
    width_ = size[0];
    show_help();
    refused_->SetPosition(edge, 12);
    help_keys_->SetPosition(edge, 12);
    help_->SetPosition(edge + help_indent, 12);
    pointer_->SetPosition(edge, 8);
    message_->SetPosition(layout.status.size[0] - edge, 8);
}

}  // namespace palpate::seeds
