// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <memory>
#include <string>

#include "tools/commands/seeds/grey_presets.hpp"
#include "tools/commands/seeds/growth.hpp"
#include "tools/commands/seeds/seed_state.hpp"

namespace palpate {

/// What the window is opened with.
struct SeedWindowSettings {
    std::string title;  ///< the volume's name
    SeedState state;    ///< as start_state() makes it
    GreyScale greys;    ///< at least one preset
    /// Writes seeds and returns where to; what it throws is shown, and the seeds stay unsaved.
    std::function<std::string(std::span<const Seed>)> save;
};

/// What the window leaves when it is closed.
struct SeedWindowResult {
    SeedState state;
    std::shared_ptr<const Growth> growth;  ///< of the last seeds; null if nothing ever grew
    int growths = 0;                       ///< that were shown
    double longest_growth = 0;             ///< s, from a click to its region
};

/// Opens the window and handles mouse and keyboard until it is closed (Q, Escape, its own button; a second
/// time where seeds are unsaved). One thread draws, another grows. Throws SystemFailure if no X display
/// answers, InvalidInput if a seed given lies outside the volume.
SeedWindowResult run_seed_window(const Volume& volume, SeedWindowSettings settings);

}  // namespace palpate
