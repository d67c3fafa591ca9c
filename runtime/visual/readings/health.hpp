// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "runtime/visual/actors.hpp"
#include "runtime/visual/visual_frame.hpp"

namespace palpate::visual {

/// How loop and device are, at one glance.
enum class Health {
    good,      ///< every force as computed
    limited,   ///< a TickStatus just now: the force was cut to its limits, or contacts are not solved
    no_force,  ///< a fault took the force away
};

Health health_of(const VisualFrame& frame);

/// "simulated touch, scripted hand: force as computed", in the user's language.
std::string health_text(const VisualFrame& frame);

/// Lighter the better, and of hues that colour-blind people tell apart (Okabe, Ito 2008).
Rgb health_colour(Health health);

}  // namespace palpate::visual
