// SPDX-License-Identifier: Apache-2.0
#include "runtime/apps/physical_devices.hpp"

#include <algorithm>
#include <ranges>

#include "formats/model/errors.hpp"
#include "runtime/devices/mounted_device.hpp"
#include "runtime/openigtlink/tracked_device.hpp"

namespace palpate {

std::optional<PhysicalDevice> parse_physical_device(std::string_view text) {
    constexpr std::string_view driver = "openhaptics", tracker = "igtl:";
    if (text.starts_with(tracker))
        return PhysicalDevice{{}, parse_tracker_address(text.substr(tracker.size()))};
    if (!text.starts_with(driver)) return std::nullopt;
    PhysicalDevice device;
    if (text == driver) return device;
    if (text[driver.size()] == ':')
        for (const auto name : std::views::split(text.substr(driver.size() + 1), ','))
            device.driver_names.emplace_back(name.begin(), name.end());
    if (device.driver_names.empty() ||
        std::ranges::any_of(device.driver_names, [](const std::string& name) { return name.empty(); }))
        throw UsageError({"--device", std::string(text),
                          "openhaptics, openhaptics:NAME or openhaptics:NAME,NAME",
                          "names are those of the driver's setup program"});
    return device;
}

PhysicalDevices::PhysicalDevices(const PhysicalDevice& device, const Eigen::Vector3d& start,
                                 const Eigen::Matrix3d& R_PD) {
    if (device.tracker) {
        devices_.push_back(std::make_unique<TrackedDevice>(*device.tracker));
        return;
    }
    driver_ = std::make_unique<HdSession>(HdSettings{{}, device.driver_names});
    for (Device* opened : driver_->devices())
        devices_.push_back(
            std::make_unique<MountedDevice>(*opened, mount(R_PD, workspace_middle(opened->limits()), start)));
}

std::vector<Device*> PhysicalDevices::devices() const {
    std::vector<Device*> devices;
    for (const auto& device : devices_) devices.push_back(device.get());
    return devices;
}

}  // namespace palpate
