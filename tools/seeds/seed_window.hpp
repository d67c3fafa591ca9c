// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <memory>
#include <string>

#include "tools/seeds/seed_editor.hpp"

namespace palpate::seeds {

/// What the window is opened with.
struct SeedWindowSettings {
    std::string title;  ///< the volume's name
    SeedState state;    ///< as start_state() makes it
    GreyScale greys;    ///< at least one preset
    SaveSeeds save;     ///< what it throws is shown, and the seeds stay unsaved
    Growing growing;    ///< what is shown of the seeds
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
/// answers.
SeedWindowResult run_seed_window(const Volume& volume, const SeedWindowSettings& settings);

}  // namespace palpate::seeds
