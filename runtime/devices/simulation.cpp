// SPDX-License-Identifier: Apache-2.0
#include "runtime/devices/simulation.hpp"

#include <cassert>
#include <utility>

#include "formats/model/arrays.hpp"
#include "runtime/devices/dynamics/dynamic_device.hpp"
#include "runtime/devices/guided_device.hpp"
#include "runtime/devices/mounted_device.hpp"
#include "runtime/devices/simulated_device.hpp"

namespace palpate::devices {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

HandTarget target_of(const Vector3d& position, const Quaterniond& orientation) {
    return {array_of(position), array_of(orientation)};
}

// Of several guided tools mouse and keyboard hold the last.
OpenDevices open_stiff_hands(const DeviceRequest& request) {
    OpenDevices open;
    for (const HeldTool& tool : request.tools) {
        if (tool.path) {
            open.devices.push_back(std::make_shared<SimulatedDevice>(*tool.path, request.limits, tool.shaft));
            continue;
        }
        assert(tool.place);
        const auto guided =
            std::make_shared<GuidedDevice>(target_of(tool.place->start, tool.orientation), request.limits,
                                           GuidedHand::usual_speed, tool.shaft);
        open.devices.push_back(guided);
        open.guide = [guided](const Vector3d& p, const Quaterniond& R_PT) {
            guided->set_target(target_of(p, R_PT));
        };
    }
    return open;
}

OpenDevices open_simulated(const DeviceModel& model, const DeviceRequest& request) {
    OpenDevices open;
    for (const HeldTool& tool : request.tools) {
        assert(tool.place);
        const Eigen::Isometry3d X_PD =
            mount(tool.place->R_PD, workspace_middle(limits_of(model)), tool.place->start);
        const Eigen::Isometry3d X_DP = X_PD.inverse();
        std::shared_ptr<Hand> hand;
        if (tool.path) {
            hand = std::make_shared<ScriptedHand>(mapped_path(*tool.path, X_DP));
        } else {
            const auto in_device = [X_DP](const Vector3d& p, const Quaterniond& R_PT) {
                return target_of(X_DP * p, Quaterniond(X_DP.linear()) * R_PT);
            };
            const auto guided = std::make_shared<GuidedHand>(in_device(tool.place->start, tool.orientation));
            hand = guided;
            open.guide = [guided, in_device](const Vector3d& p, const Quaterniond& R_PT) {
                guided->set_target(in_device(p, R_PT));
            };
        }
        const Vector3d shaft = X_PD.linear().transpose() * vector_of(tool.shaft);
        auto device =
            std::make_unique<DynamicDevice>(model, HandImpedance{}, std::move(hand), array_of(shaft));
        open.devices.push_back(std::make_shared<MountedDevice>(std::move(device), X_PD));
    }
    return open;
}

}  // namespace

HeldTool scripted_tool(HandPath path, const Vector3d& up, const std::array<double, 3>& shaft) {
    const DevicePlace place{path.at(0), upright(up)};
    return {.place = place, .shaft = shaft, .path = std::move(path)};
}

DeviceLimits limits_asked_by(const HapticSettings& settings) {
    return {.max_force = settings.max_force, .max_stiffness = settings.coupling_stiffness};
}

DeviceKind stiff_hand_kind() {
    return {.name = "",
            .usage = "",
            .usage_of_several = "",
            .sentence = "a hand of infinite stiffness: it is where it was told to be, whatever the force",
            .simulated = true,
            .tool_count = one_tool_without_address,
            .open = [](std::string_view, const DeviceRequest& request) { return open_stiff_hands(request); }};
}

std::vector<DeviceKind> simulated_kinds() {
    std::vector<DeviceKind> kinds;
    for (const DeviceModel& model : device_models())
        kinds.push_back({.name = model.name,
                         .usage = model.name,
                         .usage_of_several = "",
                         .sentence = "a simulated " + model.product + " in a hand that gives way",
                         .simulated = true,
                         .tool_count = one_tool_without_address,
                         .open = [model](std::string_view, const DeviceRequest& request) {
                             return open_simulated(model, request);
                         }});
    return kinds;
}

}  // namespace palpate::devices
