// SPDX-License-Identifier: Apache-2.0
// What a haptic model checks and allocates; its tick is in haptic_tick.cpp.
#include "runtime/haptics/haptic_model.hpp"

#include <algorithm>
#include <cmath>

#include "formats/model/errors.hpp"

namespace palpate::haptics {
namespace {

HapticSettings checked(const Case& patient_case) {
    if (const auto error = haptics_error(patient_case.haptics))
        throw InvalidInput({.culprit = patient_case.name,
                            .found = error->name + " " + error->found,
                            .expected = error->expected,
                            .next_step = "correct [haptics] in the case file and build again"});
    if (patient_case.rigid_bodies.empty() && patient_case.deformable_bodies.empty())
        throw InvalidInput({.culprit = patient_case.name,
                            .found = "the case has no body",
                            .expected = "at least one",
                            .next_step = "add a [[rigid]] or [[deformable]] body to the case file"});
    return patient_case.haptics;
}

ToolSettings checked_tool(const Case& patient_case) {
    const ToolSettings settings = patient_case.tool ? patient_case.tool->settings : ToolSettings{};
    if (const auto error = first_error(tool_fields, settings))
        throw InvalidInput({option_name(error->name), error->found, error->expected, ""});
    return settings;
}

// The least of a stiffness that is asked for, a device's largest one and what its damping keeps stable.
double least_of(double asked, double largest, const char* name, double damping) {
    double stiffness = asked;
    const auto limit = [&](double value, const char* what) {
        if (!(value >= 0 && std::isfinite(value)))
            throw InvalidInput(
                {"device", std::string(what) + " is " + std::to_string(value), "0 (not known) or more", ""});
        if (value > 0) stiffness = std::min(stiffness, value);
    };
    limit(largest, name);
    limit(2 * damping / tick_period, "its stability limit, 2 damping / period,");
    return stiffness;
}

// Refuses what the method cannot have.
const ContactMethodEntry& checked(const ContactMethodEntry& method, std::size_t tool_count,
                                  const std::string& case_name) {
    if (tool_count > method.can.most_tools)
        throw InvalidInput({case_name, std::to_string(tool_count) + " tools",
                            std::to_string(method.can.most_tools) + " at most with contact method '" +
                                std::string(method.name) + "'",
                            "use " + contact_method_names(tool_count)});
    return method;
}

}  // namespace

double coupling_stiffness(const HapticSettings& settings, const DeviceLimits& device) {
    return least_of(settings.coupling_stiffness, device.max_stiffness, "its largest stiffness",
                    device.damping);
}

double torsional_stiffness(const ToolSettings& settings, const DeviceLimits& device) {
    if (!(device.max_torque >= 0 && std::isfinite(device.max_torque)))
        throw InvalidInput({"device", "its largest torque is " + std::to_string(device.max_torque),
                            "0 (it renders none) or more", ""});
    if (device.max_torque == 0) return settings.torsional_stiffness;
    return least_of(settings.torsional_stiffness, device.max_torsional_stiffness,
                    "its largest torsional stiffness", device.torsional_damping);
}

HapticModel::HapticModel(const Case& patient_case, std::string_view method, std::size_t tool_count)
    : settings_(checked(patient_case)),
      tool_settings_(checked_tool(patient_case)),
      method_(checked(find_contact_method(method), tool_count, patient_case.name)),
      coupling_{settings_.coupling_stiffness, tool_settings_.torsional_stiffness},
      contact_radius_(method_.can.has_radius ? tip_reach(patient_case) : 0),
      turns_(method_.can.always_turns || (method_.can.turns && patient_case.tool)),
      bodies_(patient_case, method_.can.spreads_loads),
      tools_(tool_count, Tool{ForceLimiter(settings_), ForceLimiter(tool_settings_)}),
      poses_(tool_count),
      forces_(tool_count),
      contact_(method_.make(patient_case, bodies_, tool_count)),
      observer_(tool_count, tool_length(patient_case), has_instrument(patient_case)) {}

void HapticModel::couple_to(std::span<const DeviceLimits> devices) {
    coupling_ = {settings_.coupling_stiffness, tool_settings_.torsional_stiffness};
    for (const DeviceLimits& device : devices) {
        coupling_.stiffness = std::min(coupling_.stiffness, coupling_stiffness(settings_, device));
        coupling_.torsional_stiffness =
            std::min(coupling_.torsional_stiffness, torsional_stiffness(tool_settings_, device));
        for (Tool& tool : tools_) {
            if (device.max_force > 0) tool.limiter.lower_to(device.max_force);
            if (device.max_torque > 0) tool.torque_limiter.lower_to(device.max_torque);
        }
    }
    for (std::size_t t = 0; t < tools_.size(); ++t) {
        tools_[t].feels_torque = turns_ && t < devices.size() && devices[t].max_torque > 0;
        observer_.count_torque(t, tools_[t].feels_torque);
    }
}

bool HapticModel::torque_is_felt() const noexcept {
    return std::ranges::all_of(tools_, &Tool::feels_torque);
}

std::int64_t HapticModel::memory_ticks() const noexcept {
    std::int64_t ticks = 0;
    if (method_.can.creeps)
        for (const DeformableContact& body : bodies_.deformable) ticks = std::max(ticks, body.memory_ticks());
    return ticks;
}

void HapticModel::reset() noexcept {
    for (Tool& tool : tools_) {
        tool.limiter.reset();
        tool.torque_limiter.reset();
        tool.lost = false;
    }
    contact_->reset();
    observer_.reset();
    tick_ = 0;
}

}  // namespace palpate::haptics
