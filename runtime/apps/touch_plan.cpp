// SPDX-License-Identifier: Apache-2.0
#include "runtime/apps/touch_plan.hpp"

#include <algorithm>
#include <array>
#include <sstream>

#include "formats/model/errors.hpp"
#include "runtime/apps/hand_script.hpp"
#include "runtime/apps/simulation.hpp"
#include "runtime/devices/mounted_device.hpp"
#include "runtime/devices/simulated_device.hpp"

namespace palpate {
namespace {

std::optional<Eigen::Vector3d> point_of(const char* option, std::string text) {
    if (text.empty()) return std::nullopt;
    std::istringstream stream(text);
    Eigen::Vector3d p;
    char comma = ',', other_comma = ',';
    stream >> p[0] >> comma >> p[1] >> other_comma >> p[2];
    if (!stream || comma != ',' || other_comma != ',' || stream.peek() != EOF)
        throw UsageError({option, text, "x,y,z", ""});
    return p;
}

// At least one tick, so that there is something to report.
void require_positive(double seconds) {
    if (!(seconds >= 1e-3)) throw UsageError({"--seconds", std::to_string(seconds), "0.001 or more", ""});
}

// From the tip along the shaft: as asked, or straight out of the place that is touched.
std::array<double, 3> shaft_of(const TouchOptions& options, const TouchPlan& plan) {
    Eigen::Vector3d along = plan.target ? plan.target->place.normal : Eigen::Vector3d::Zero();
    if (const auto asked = point_of("--shaft", options.shaft)) {
        if (!(asked->norm() > 0)) throw UsageError({"--shaft", options.shaft, "a direction", ""});
        along = asked->normalized();
    }
    return {along[0], along[1], along[2]};
}

// `up`: which way out of the patient a device of its own frame is turned.
std::unique_ptr<Device> device_of(const TouchOptions& options, const HapticModel& model, HandPath path,
                                  const Eigen::Vector3d& up, const std::array<double, 3>& shaft) {
    if (!options.device.empty()) return simulate(find_device_model(options.device), path, up, shaft);
    const DeviceLimits limits{.max_force = model.settings().max_force,
                              .max_stiffness = model.settings().coupling_stiffness};
    return std::make_unique<SimulatedDevice>(std::move(path), limits, shaft);
}

}  // namespace

TouchPlan plan_of(const TouchOptions& options, bool physical, const Case& patient_case,
                  const HapticModel& model) {
    if (!physical && !options.column && !is_made_to_measure(options.script)) {
        HandPath path = recorded_path(options.script);
        const double seconds = options.seconds_given ? options.seconds : path.duration();
        require_positive(seconds);
        return {std::move(path), std::nullopt, seconds};
    }
    if (!options.column) require_positive(options.seconds);
    const TouchTarget target =
        choose_touch_target(patient_case, model, options.body, point_of("--target", options.target));
    if (physical) return {std::nullopt, target, options.seconds};
    // The published schemes know the tip's centre alone.
    const bool has_radius = model.scheme() == ContactScheme::continuous;
    const ScriptSettings settings{.tool_radius = has_radius ? model.settings().tool_radius : 0,
                                  .depth = options.depth,
                                  .speed = options.speed,
                                  .seconds = options.seconds};
    if (!options.column)
        return {made_to_measure_path(options.script, target.place, settings, options.seed), target,
                options.seconds};
    HandPath path = recorded_axis_path(options.script, *options.column, target.place, settings);
    const double seconds = options.seconds_given ? options.seconds : path.duration();
    require_positive(seconds);
    return {std::move(path), target, seconds};
}

HeldDevices hold(const TouchOptions& options, const std::optional<PhysicalDevice>& physical,
                 const TouchPlan& plan, const HapticModel& model) {
    HeldDevices held;
    const Eigen::Vector3d up = plan.target ? plan.target->place.normal : anterior;
    if (physical) {
        const Eigen::Vector3d start = start_outside(plan.target->place, model.settings().tool_radius);
        held.physical = std::make_unique<PhysicalDevices>(*physical, start, upright(up));
        held.devices = held.physical->devices();
        held.servo = held.physical->servo();
        return held;
    }
    const std::array<double, 3> shaft = shaft_of(options, plan);
    held.simulated.push_back(device_of(options, model, *plan.path, up, shaft));
    if (!options.second.empty())
        held.simulated.push_back(device_of(options, model, recorded_path(options.second), anterior, shaft));
    for (const auto& device : held.simulated) held.devices.push_back(device.get());
    return held;
}

void refuse_idle_options(const cli::Command& command, const TouchOptions& options) {
    constexpr std::array of_scripts{"--script", "--column", "--depth", "--speed", "--shaft", "--seed"};
    const bool physical = parse_physical_device(options.device).has_value();
    for (const cli::Parameter& parameter : command.parameters()) {
        if (!parameter.option.given()) continue;
        const std::string name = parameter.option.name();
        if (physical && std::ranges::find(of_scripts, name) != of_scripts.end())
            throw UsageError({name, "with --device " + options.device, "a simulated device", ""});
        if (name == "--record-seconds" && options.record.empty())
            throw UsageError({name, "without --record", "--record FILE beside it", ""});
    }
}

void refuse_contradictions(const TouchOptions& options, const std::optional<PhysicalDevice>& physical) {
    const bool continuous = find_contact_scheme(options.scheme) == ContactScheme::continuous;
    if (!options.second.empty() && !continuous)
        throw UsageError({"--second", "with --scheme " + options.scheme, "the scheme 'continuous'",
                          "the published schemes know one tool"});
    if (options.virtual_clock && !options.stream.empty())
        throw UsageError({"--stream", "with --virtual-clock", "the real clock", ""});
    if (!physical) return;
    const std::string with = "with --device " + options.device;
    if (options.virtual_clock)
        throw UsageError({"--virtual-clock", with, "the real clock", "a hand keeps its own time"});
    if (!options.second.empty())
        throw UsageError({"--second", with, "--device openhaptics:NAME,NAME", "a hand holds each device"});
    if (physical->tool_count() > 1 && !continuous)
        throw UsageError({"--scheme", options.scheme + " with several devices", "the scheme 'continuous'",
                          "the published schemes know one tool"});
}

}  // namespace palpate
