// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/seeds/seed_state.hpp"

#include <algorithm>
#include <cmath>

#include "formats/model/errors.hpp"

namespace palpate::seeds {
namespace {

using namespace imaging;

constexpr std::size_t most_structures = 9;  // one number key each

void change(SeedState& state, std::vector<Seed> seeds) {
    state.past.push_back(std::move(state.seeds));
    state.seeds = std::move(seeds);
}

std::int32_t clamped(const ImageGrid& grid, std::size_t axis, double index) {
    const double last = grid.size[axis] - 1;
    return static_cast<std::int32_t>(std::lround(std::clamp(index, 0.0, last)));
}

}  // namespace

SeedState start_state(const ImageGrid& grid, const std::vector<std::string>& labels,
                      const std::vector<Seed>& seeds) {
    SeedState state;
    const auto add = [&](const std::string& label) {
        if (std::ranges::find(state.labels, label) == state.labels.end()) state.labels.push_back(label);
    };
    for (const std::string& label : labels) add(label);
    for (const Seed& seed : seeds) add(seed.label);
    if (state.labels.size() > most_structures + 1)
        throw UsageError({"--label", std::to_string(state.labels.size() - 1) + " structures",
                          std::to_string(most_structures) + " or fewer",
                          "open the window once for each few"});
    state.active = state.labels.size() > 1 ? 1 : 0;
    state.seeds = state.saved = seeds;
    const Eigen::Vector3d middle = Eigen::Vector3d(grid.size[0], grid.size[1], grid.size[2]) / 2;
    move_crosshair(state, grid, seeds.empty() ? middle : grid.index_of(seeds.back().p_P));
    return state;
}

void place_seed(SeedState& state, const ImageGrid& grid, const Eigen::Vector3d& index) {
    std::vector<Seed> seeds = state.seeds;
    seeds.push_back({state.labels[state.active], grid.point_of(index)});
    change(state, std::move(seeds));
    move_crosshair(state, grid, index);
}

bool remove_nearest(SeedState& state, const Eigen::Vector3d& p_P, double radius) {
    const auto distance = [&](const Seed& seed) { return (seed.p_P - p_P).norm(); };
    const auto nearest = std::ranges::min_element(state.seeds, {}, distance);
    if (nearest == state.seeds.end() || distance(*nearest) > radius) return false;
    std::vector<Seed> seeds = state.seeds;
    seeds.erase(seeds.begin() + (nearest - state.seeds.begin()));
    change(state, std::move(seeds));
    return true;
}

bool remove_last(SeedState& state) {
    if (state.seeds.empty()) return false;
    change(state, {state.seeds.begin(), state.seeds.end() - 1});
    return true;
}

bool undo(SeedState& state) {
    if (state.past.empty()) return false;
    state.seeds = std::move(state.past.back());
    state.past.pop_back();
    return true;
}

bool choose_label(SeedState& state, std::size_t number) {
    if (number >= state.labels.size()) return false;
    state.active = number;
    return true;
}

void move_crosshair(SeedState& state, const ImageGrid& grid, const Eigen::Vector3d& index) {
    for (std::size_t axis = 0; axis < 3; ++axis)
        state.crosshair[axis] = clamped(grid, axis, index[static_cast<Eigen::Index>(axis)]);
}

void scroll(SeedState& state, const ImageGrid& grid, const SliceView& view, int steps) {
    const auto axis = static_cast<std::size_t>(view.across);
    state.crosshair[axis] = clamped(grid, axis, state.crosshair[axis] + steps * view.away);
}

std::array<float, 3> label_colour(std::size_t number) {
    constexpr std::array<std::array<float, 3>, most_structures + 1> colours{{{0.75F, 0.75F, 0.75F},
                                                                             {1.00F, 0.72F, 0.10F},
                                                                             {0.25F, 0.80F, 1.00F},
                                                                             {0.35F, 0.95F, 0.40F},
                                                                             {1.00F, 0.40F, 0.30F},
                                                                             {1.00F, 0.50F, 0.90F},
                                                                             {0.95F, 0.95F, 0.25F},
                                                                             {0.30F, 0.95F, 0.85F},
                                                                             {0.65F, 0.55F, 1.00F},
                                                                             {0.85F, 0.65F, 0.45F}}};
    return colours[number % colours.size()];
}

bool unsaved(const SeedState& state) {
    return !std::ranges::equal(state.seeds, state.saved, [](const Seed& a, const Seed& b) {
        return a.label == b.label && a.p_P == b.p_P;
    });
}

}  // namespace palpate::seeds
