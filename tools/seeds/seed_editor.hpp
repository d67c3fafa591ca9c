// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <memory>
#include <span>
#include <string>

#include "tools/seeds/grey_presets.hpp"
#include "tools/seeds/growth.hpp"
#include "tools/seeds/seed_state.hpp"

namespace palpate::seeds {

/// Writes seeds and returns where to; throws an Error if it cannot.
using SaveSeeds = std::function<std::string(std::span<const imaging::Seed>)>;

/// What mouse and keyboard mean: changes the seeds and how they are looked at, and lets them grow. Knows
/// nothing of windows. One thread, beside the one that grows.
class SeedEditor {
  public:
    /// Keeps a reference to `volume`. `greys` has at least one preset.
    SeedEditor(const Volume& volume, SeedState state, GreyScale greys, SaveSeeds save, Growing growing);

    void place(const Eigen::Vector3d& index);
    /// Removes the seed nearest to a continuous voxel index within `reach` (mm).
    void remove(const Eigen::Vector3d& index, double reach);
    void move_crosshair(const Eigen::Vector3d& index);
    void scroll(const SliceView& view, int steps);
    /// Changes the width of the grey window by a pixel distance to the right, its level by one upwards.
    void drag_grey(double right, double up);
    /// Does what a key stands for, by its X name in lower case; unknown keys do nothing.
    void key(const std::string& name);
    /// Closes; where seeds are unsaved only when asked twice in a row.
    void quit();
    void say(const std::string& message);

    /// Takes what has grown; throws as GrowthWorker::take().
    void poll();
    /// Waits for the growth under way, so that growth() is that of the last seeds.
    void finish();

    const SeedState& state() const { return state_; }
    const GreyPreset& grey() const { return grey_; }
    const std::shared_ptr<const Growth>& growth() const { return growth_; }
    const std::string& message() const { return message_; }
    double zoom() const { return zoom_; }
    int growths() const { return growths_; }
    double longest_growth() const { return longest_growth_; }  ///< s
    bool closed() const { return closed_; }
    /// Counts up with every change of what is to be seen.
    int revision() const { return revision_; }

  private:
    void grow();
    void next_grey(std::size_t steps);
    void save();
    void acted();
    std::string growth_text() const;

    const Volume& volume_;
    SeedState state_;
    GreyScale greys_;
    SaveSeeds save_;
    GreyPreset grey_;
    std::size_t preset_ = 0;
    double zoom_ = 1;
    std::string message_ = "click into the structure";
    std::shared_ptr<const Growth> growth_;
    int growths_ = 0;
    double longest_growth_ = 0;
    bool asked_to_quit_ = false;
    bool closed_ = false;
    int revision_ = 1;
    GrowthWorker worker_;
};

}  // namespace palpate::seeds
