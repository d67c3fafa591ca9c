// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/experiments/puncture/approach_run.hpp"

#include <algorithm>
#include <cmath>

#include "formats/model/arrays.hpp"

namespace palpate::experiments {
namespace {

using namespace devices;
using Eigen::Vector3d;

constexpr double approach_tick_s = 1e-3;
constexpr double just_before = 2;  // mm: beyond what a bump beside the entry holds up

// Whether the tool overlaps the surface or is beneath it, by less than a fast tool goes in some ticks.
bool is_in_surface(const collision::CollisionSurface& surface, const Vector3d& tool, double radius) {
    constexpr double rounding = 1e-6, beneath = 5;  // mm
    const auto nearest = surface.closest_point(tool, beneath);
    return nearest && (nearest->distance < radius - rounding || !surface.is_outside(tool, *nearest));
}

}  // namespace

Outcome run_approach(haptics::HapticModel& model, const DeviceModel& device_model, const Approach& approach,
                     bool watch_tool, const std::function<void(const ApproachTick&)>& sink) {
    const auto& [entry, direction, thickness] = approach.place;
    const double arrival = (Approach::run_up + Approach::stroke) / approach.speed;
    const double end = arrival + Approach::press_s;
    DynamicDevice device(device_model, approach.hand,
                         HandPath({{0, entry - Approach::run_up * direction},
                                   {arrival, entry + Approach::stroke * direction}}));
    model.reset();
    Outcome outcome;
    TickResult result{};
    Vector3d tool = device.position();
    double contact = -1, held_sum = 0;
    int judged = 0;
    for (int tick = 0; approach_tick_s * tick <= end; ++tick) {
        const double time = approach_tick_s * tick;
        realtime::DeviceState state = device.read(time);
        model.tick(state, result);
        device.write({result.force});
        if (detects_at(time, approach.phase)) model.detect();

        const Vector3d way = device.position() - entry;
        const double depth = way.dot(direction);
        const double along = vector_of(result.force).dot(direction);
        if (depth <= -just_before) outcome.speed = device.velocity().dot(direction);
        if (contact < 0 && depth >= 0) contact = time;
        if (outcome.latency < 0 && along != 0) {
            outcome.latency = contact < 0 ? 0 : time - contact;
            outcome.depth_at_force = depth;
        }
        outcome.deepest = std::max(outcome.deepest, depth);
        outcome.aside = std::max(outcome.aside, (way - depth * direction).norm());
        outcome.pull = std::max(outcome.pull, along);
        if (time > end - Approach::judged_s) {
            held_sum -= along;
            ++judged;
        }
        if (watch_tool) {
            const Vector3d now = vector_of(result.tool_position);
            outcome.tool_in_surface |= is_in_surface(model.surface(0), now, model.settings().tool_radius);
            outcome.way_crossed |= model.surface(0).sweep_sphere(tool, now, 0).has_value();
            tool = now;
        }
        if (sink) sink({time, depth, -along});
    }
    outcome.held = held_sum / judged;
    return outcome;
}

bool detects_at(double time, double phase) {
    const auto detections = [&](double t) { return std::floor(Approach::detections_per_s * t + phase); };
    return detections(time) > detections(time - approach_tick_s);
}

double unbroken_force(double coupling_stiffness, double hand_stiffness) {
    return Approach::stroke * coupling_stiffness * hand_stiffness / (coupling_stiffness + hand_stiffness);
}

bool is_puncture(const Outcome& outcome, double coupling_stiffness, double hand_stiffness) {
    return outcome.held < unbroken_force(coupling_stiffness, hand_stiffness) / 2;
}

bool is_pulled(const Outcome& outcome) {
    constexpr double felt = 0.1;  // N
    return outcome.pull > felt;
}

}  // namespace palpate::experiments
