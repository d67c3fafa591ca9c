// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/seeds/seed_editor.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "formats/model/errors.hpp"

namespace palpate::seeds {
namespace {

constexpr double contrast_step = 200;  // pixels of drag for a factor of e
constexpr double largest_zoom = 4;

std::string count_text(std::size_t seeds) {
    return fmt::format("{} seed{}", seeds, seeds == 1 ? "" : "s");
}

}  // namespace

SeedEditor::SeedEditor(const Volume& volume, SeedState state, GreyScale greys, SaveSeeds save,
                       Growing growing)
    : volume_(volume),
      state_(std::move(state)),
      greys_(std::move(greys)),
      save_(std::move(save)),
      grey_(greys_.presets.front()),
      worker_(std::move(growing)) {
    if (!state_.seeds.empty()) grow();
}

void SeedEditor::acted() {
    asked_to_quit_ = false;
    ++revision_;
}

void SeedEditor::say(const std::string& message) {
    message_ = message;
    ++revision_;
}

void SeedEditor::grow() {
    worker_.request(state_.seeds);
    say(state_.seeds.empty() ? "no seeds left" : "growing ...");
}

void SeedEditor::poll() {
    const auto grown = worker_.take();
    if (!grown) return;
    growth_ = grown;
    ++revision_;
    if (!grown->refused.empty()) return say("nothing could be made of these seeds");
    if (grown->map.labels.empty()) return;
    ++growths_;
    longest_growth_ = std::max(longest_growth_, grown->seconds);
    if (!worker_.busy()) say(growth_text());
}

void SeedEditor::finish() {
    worker_.wait();
    poll();
}

std::string SeedEditor::growth_text() const {
    std::string text;
    for (std::size_t n = 0; n < growth_->map.names.size(); ++n)
        if (growth_->map.names[n].name == state_.labels[state_.active])
            text = fmt::format("{} {:.1f} ml, ", growth_->map.names[n].name, growth_->volume_ml[n]);
    return text + fmt::format("grown in {:.2f} s", growth_->seconds);
}

void SeedEditor::place(const Eigen::Vector3d& index) {
    acted();
    place_seed(state_, volume_.grid, index);
    grow();
}

void SeedEditor::remove(const Eigen::Vector3d& index, double reach) {
    acted();
    if (remove_nearest(state_, volume_.grid.point_of(index), reach))
        grow();
    else
        say("no seed here");
}

void SeedEditor::move_crosshair(const Eigen::Vector3d& index) {
    acted();
    palpate::seeds::move_crosshair(state_, volume_.grid, index);
}

void SeedEditor::scroll(const SliceView& view, int steps) {
    acted();
    palpate::seeds::scroll(state_, volume_.grid, view, steps);
}

void SeedEditor::drag_grey(double right, double up) {
    acted();
    grey_.name = "your own";
    grey_.width *= std::exp(right / contrast_step);
    grey_.level -= up * grey_.width / (2 * contrast_step);
}

void SeedEditor::next_grey(std::size_t steps) {
    preset_ = (preset_ + steps) % greys_.presets.size();
    grey_ = greys_.presets[preset_];
}

void SeedEditor::key(const std::string& name) {
    if (name == "q" || name == "escape") return quit();
    acted();
    if (name.size() == 1 && name[0] >= '0' && name[0] <= '9')
        choose_label(state_, static_cast<std::size_t>(name[0] - '0'));
    else if (name == "plus" || name == "equal" || name == "kp_add")
        next_grey(1);
    else if (name == "minus" || name == "kp_subtract")
        next_grey(greys_.presets.size() - 1);
    else if (name == "z")
        zoom_ = zoom_ < largest_zoom ? 2 * zoom_ : 1;
    else if (name == "s")
        save();
    else if (((name == "x" || name == "delete") && remove_last(state_)) || (name == "u" && undo(state_)))
        grow();
}

void SeedEditor::save() {
    if (state_.seeds.empty()) return say("nothing to save: click into the structure first");
    try {
        const std::string place = save_(state_.seeds);
        state_.saved = state_.seeds;
        say(fmt::format("saved {} to {}", count_text(state_.seeds.size()), place));
    } catch (const Error& error) {
        say(error.what());
    }
}

void SeedEditor::quit() {
    closed_ = asked_to_quit_ || !unsaved(state_);
    asked_to_quit_ = true;
    if (!closed_) say("seeds are not saved: S saves, Q again quits without");
}

}  // namespace palpate::seeds
