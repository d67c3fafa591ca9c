// SPDX-License-Identifier: Apache-2.0
#include "runtime/apps/touch_plan.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <sstream>

#include "formats/model/arrays.hpp"
#include "formats/model/errors.hpp"
#include "runtime/apps/options/point_option.hpp"
#include "runtime/devices/jaws/jaws.hpp"
#include "runtime/devices/mounted_device.hpp"
#include "runtime/devices/simulation.hpp"
#include "runtime/session/hand_script.hpp"
#include "tools/cli/refuse_beside.hpp"

namespace palpate::apps {
namespace {

using namespace devices;
using namespace haptics;
using namespace session;

// At least one tick, so that there is something to report; a script is made as a whole before it is played.
void require_playable(double seconds) {
    constexpr double longest = 86400;
    if (!(seconds >= 1e-3 && seconds <= longest))
        throw UsageError({"--seconds", fmt::format("{:g}", seconds), "0.001 to 86400, a day", ""});
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

constexpr double random_turn = 0.5;  // rad, a choice

// Deeper than hands press organs: perhaps a unit was mistaken.
void question_depth(double depth) {
    constexpr double most = 50;  // mm
    if (depth > most)
        spdlog::warn("a press of {:g} mm depth is implausible; up to {:g} mm is usual. Is the unit right?",
                     depth, most);
}

TouchPlan grasp_plan(const TouchOptions& options, const DeviceKind& device, const Case& patient_case,
                     const HapticModel& model) {
    TouchPlan plan{.path = {}, .target = {}, .grasp = {}, .seconds = options.seconds};
    plan.grasp = choose_grasp_place(patient_case, model, options.tool.jaws, options.body,
                                    point_of("--target", options.target));
    if (device.simulated)
        plan.path = grasp_path(plan.grasp->grasp, options.tool.jaws,
                               {.pull = options.depth, .speed = options.speed, .seconds = options.seconds});
    return plan;
}

}  // namespace

TouchPlan plan_of(const TouchOptions& options, const DeviceKind& device, const Case& patient_case,
                  const HapticModel& model) {
    if (device.simulated && !options.column && !is_made_to_measure(options.script)) {
        HandPath path = recorded_path(options.script, options.tool.has_jaws());
        const double seconds = options.seconds_given ? options.seconds : path.duration();
        require_playable(seconds);
        return {.path = std::move(path), .target = {}, .grasp = {}, .seconds = seconds};
    }
    if (!options.column) require_playable(options.seconds);
    if (options.tool.has_jaws()) return grasp_plan(options, device, patient_case, model);
    const TouchTarget target =
        choose_touch_target(patient_case, model, options.body, point_of("--target", options.target));
    if (!device.simulated) return {.path = {}, .target = target, .grasp = {}, .seconds = options.seconds};
    question_depth(options.depth);
    const ScriptSettings settings{.tool_radius = model.contact_radius(),
                                  .depth = options.depth,
                                  .speed = options.speed,
                                  .seconds = options.seconds,
                                  .turn = patient_case.tool && options.shaft.empty() ? random_turn : 0};
    if (!options.column)
        return {.path = made_to_measure_path(options.script, target.place, settings, options.seed),
                .target = target,
                .grasp = {},
                .seconds = options.seconds};
    HandPath path = recorded_axis_path(options.script, *options.column, target.place, settings);
    const double seconds = options.seconds_given ? options.seconds : path.duration();
    require_playable(seconds);
    return {.path = std::move(path), .target = target, .grasp = {}, .seconds = seconds};
}

DeviceRequest request_of(const TouchOptions& options, const DeviceKind& device, const TouchPlan& plan,
                         const HapticModel& model) {
    DeviceRequest request{.tools = {}, .limits = limits_asked_by(model.settings())};
    if (options.tool.has_jaws()) request.limits = limits_of_both(request.limits);
    const Eigen::Vector3d up = plan.target ? plan.target->place.normal : anterior;
    if (plan.grasp) {
        const Grasp& grasp = plan.grasp->grasp;
        const DevicePlace place{grasp.outside(), upright(grasp.out())};
        request.tools.push_back(plan.path ? scripted_tool(*plan.path, grasp.out(), array_of(grasp.out()))
                                          : HeldTool{.place = place});
        return request;
    }
    if (!device.simulated) {  // several at one place, so that all reach what one does
        const DevicePlace place{
            start_outside(plan.target->place, std::max(model.settings().tool_radius, model.contact_radius())),
            upright(up)};
        request.tools.assign(model.tool_count(), HeldTool{.place = place});
        return request;
    }
    const std::array<double, 3> shaft = shaft_of(options, plan);
    request.tools.push_back(scripted_tool(*plan.path, up, shaft));
    if (!options.second.empty())
        request.tools.push_back(scripted_tool(recorded_path(options.second), anterior, shaft));
    return request;
}

std::size_t tools_of(const TouchOptions& options, const DeviceChoice& device) {
    return options.second.empty() && !options.tool.has_jaws() ? device.tool_count : 2;
}

void refuse_idle_options(const cli::Command& command, const TouchOptions& options) {
    constexpr std::array of_scripts{"--script", "--column", "--depth", "--speed", "--shaft", "--seed"};
    const bool physical = !choose_device(options.device, "--device").kind.simulated;
    constexpr std::array of_one_tip{"--column", "--shaft", "--seed"};
    for (const cli::Parameter& parameter : command.parameters()) {
        if (!cli::asked_for(parameter)) continue;
        const std::string name = parameter.option.name();
        if (options.tool.has_jaws() && std::ranges::find(of_one_tip, name) != of_one_tip.end())
            throw UsageError({name, "with --instrument forceps", "", "leave it out"});
        if (physical && std::ranges::find(of_scripts, name) != of_scripts.end())
            throw UsageError({name, "with --device " + options.device, "a simulated device", ""});
        if (name == "--record-seconds" && options.record.empty())
            throw UsageError({name, "without --record", "--record FILE beside it", ""});
    }
}

void refuse_contradictions(const TouchOptions& options, const DeviceChoice& device) {
    const ContactMethodEntry& method = find_contact_method(options.scheme, "--scheme");
    const std::size_t tools = tools_of(options, device);
    const std::string with = "with --device " + options.device;
    check_hand(options.tool, options.script, device, options.second);
    if (options.virtual_clock && !options.stream.empty())
        throw UsageError({"--stream", "with --virtual-clock", "the real clock", ""});
    if (!device.kind.simulated && options.virtual_clock)
        throw UsageError({"--virtual-clock", with, "the real clock", "a hand keeps its own time"});
    if (!device.kind.simulated && !options.second.empty())
        throw UsageError({"--second", with, "a simulated device", "a hand holds each device"});
    const std::size_t most = method.can.most_tools;
    if (tools > most)
        throw UsageError(
            {options.second.empty() ? "--device" : "--second", "with --scheme " + options.scheme,
             "the scheme " + contact_method_names(tools),
             "'" + options.scheme + "' knows " + (most == 1 ? "one tool" : std::to_string(most) + " tools")});
}

}  // namespace palpate::apps
