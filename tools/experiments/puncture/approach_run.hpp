// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>

#include "formats/records/haptic_settings.hpp"
#include "runtime/devices/dynamics/dynamic_device.hpp"
#include "runtime/haptics/haptic_model.hpp"
#include "tools/experiments/puncture/approaches.hpp"

namespace palpate::experiments {

/// Of everything that the experiment touches.
inline constexpr HapticSettings approach_settings{
    .tool_radius = 0.5, .coupling_stiffness = 1.0, .max_force = 7.9, .max_force_rate = 7.9};

/// One approach: the hand goes straight at `speed` from run_up before the entry to stroke behind it, where it
/// stays and presses for press_s.
struct Approach {
    static constexpr double run_up = 40, stroke = 10;        // mm
    static constexpr double press_s = 0.3, judged_s = 0.05;  // s
    static constexpr double detections_per_s = 30;

    Place place;
    double speed = 145;  ///< of the hand, mm/s
    double phase = 0;    ///< 0 ... 1, of the detection loop when the hand sets out
    devices::HandImpedance hand{};
};

/// What came of it. Along the approach is positive inwards.
struct Outcome {
    double held = 0;               ///< mean force against the approach over the last judged_s, N
    double pull = 0;               ///< largest force along the approach, N
    double speed = 0;              ///< of the tip 2 mm before the entry, mm/s
    double latency = -1;           ///< s from passing the entry to the first force; -1: there was none
    double depth_at_force = 0;     ///< mm behind the entry at the first force
    double deepest = 0;            ///< of the tip, mm behind the entry
    double aside = 0;              ///< farthest that the tip came off the line of approach, mm
    bool tool_in_surface = false;  ///< the tool itself, as drawn, overlapped the surface or was beneath it
    bool way_crossed = false;      ///< its straight way from a tick to the next went through the surface, as
                                   ///< it does round an edge too
};

/// What a tick saw, for curves.
struct ApproachTick {
    double time, depth, force;  // s, mm behind the entry, N against the approach
};

/// Runs an approach on virtual time: each ms read, tick, write; then, where the detection loop's time has
/// come, detect(). The model forgets what was before. `watch_tool`: also checks the tool itself every tick.
Outcome run_approach(haptics::HapticModel& model, const devices::DeviceModel& device,
                     const Approach& approach, bool watch_tool,
                     const std::function<void(const ApproachTick&)>& sink = {});

/// Whether the detection loop, 30 times a second from `phase` on, comes by in the tick at `time` (s).
bool detects_at(double time, double phase);

/// The force that an unbroken wall would hold the hand back with at the stroke's end: coupling and hand in
/// series, N. A puncture is an approach with less than half of it at its end.
double unbroken_force(double coupling_stiffness, double hand_stiffness = devices::HandImpedance{}.stiffness);
bool is_puncture(const Outcome& outcome, double coupling_stiffness,
                 double hand_stiffness = devices::HandImpedance{}.stiffness);
/// Ever drawn inwards by more than 0.1 N.
bool is_pulled(const Outcome& outcome);

}  // namespace palpate::experiments
