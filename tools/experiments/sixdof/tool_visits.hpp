// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <random>
#include <vector>

#include "runtime/devices/hand_path.hpp"
#include "tools/experiments/puncture/approaches.hpp"

namespace palpate::experiments {

/// A tool that touches a bone at a place, turned as it comes: its path, and where it went in.
struct ToolVisit {
    Place place;
    devices::HandPath path;
    double rests_from = 0, rests_until = 0;  ///< s: the hand is still, the tool pressed
};

/// Where a visit's tool starts outside the place, and how deep its device goes, mm.
inline constexpr double visit_start = 20, visit_depth = 3;

/// A visit: the tool, whose surface reaches `reach` mm beyond its tip's centre, comes along the outward
/// normal at 20 to 200 mm/s, its shaft up to 40 degrees off it, goes 3 mm deep, slides 10 mm along the
/// surface while it turns by up to 30 degrees about any axis, rests for 0.3 s, and leaves.
ToolVisit pressing_visit(const Place& place, double reach, std::mt19937_64& random);

/// A fast visit: it comes at 50 to 1 000 mm/s, turning at up to 20 rad/s about any axis, straight to
/// `stroke` mm beyond the surface, and stays there for 0.02 s.
ToolVisit fast_visit(const Place& place, double reach, double stroke, std::mt19937_64& random);

}  // namespace palpate::experiments
