// SPDX-License-Identifier: Apache-2.0
#include "runtime/devices/openhaptics/hd_kind.hpp"

#include <algorithm>
#include <ranges>

#include "runtime/devices/mounted_device.hpp"
#include "runtime/devices/openhaptics/hd_session.hpp"

namespace palpate::devices {
namespace {

std::vector<std::string> names_in(std::string_view address) {
    std::vector<std::string> names;
    for (const auto name : std::views::split(address, ',')) names.emplace_back(name.begin(), name.end());
    return names;
}

std::optional<std::size_t> count_names(std::string_view address) {
    const std::vector<std::string> names = names_in(address);
    if (std::ranges::any_of(names, [](const std::string& name) { return name.empty(); })) return {};
    return std::max<std::size_t>(1, names.size());
}

OpenDevices open_driver(std::string_view address, const DeviceRequest& request) {
    const auto session = std::make_shared<HdSession>(HdSettings{{}, names_in(address)});
    OpenDevices open{.driver = session, .devices = {}, .servo = &session->servo()};
    for (std::size_t t = 0; t < request.tools.size(); ++t) {
        realtime::Device* device = session->devices()[t];
        if (const auto& place = request.tools[t].place)
            open.devices.push_back(std::make_shared<MountedDevice>(
                *device, mount(place->R_PD, workspace_middle(device->limits()), place->start)));
        else
            open.devices.emplace_back(session, device);
    }
    return open;
}

}  // namespace

DeviceKind openhaptics_kind() {
    return {.name = "openhaptics",
            .usage = "openhaptics[:NAME]",
            .usage_of_several = "openhaptics:NAME,NAME",
            .sentence =
                "Phantoms and Touches, one tool each, by the names of the driver's setup program "
                "(PALPATE_HD_LIBRARY may name the driver's library)",
            .tool_count = count_names,
            .open = open_driver};
}

}  // namespace palpate::devices
