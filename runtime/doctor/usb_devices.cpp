// SPDX-License-Identifier: Apache-2.0
#include "runtime/doctor/usb_devices.hpp"

#include <algorithm>
#include <unistd.h>

namespace palpate::doctor {
namespace {

// The name of the character device that the kernel made of a USB device's interfaces.
std::string node_below(const std::filesystem::path& device) {
    constexpr int deepest = 6;  // interface, HID device, its class, the node, and room for a hub's child
    std::error_code error;
    std::vector<std::string> nodes;
    auto entry = std::filesystem::recursive_directory_iterator(device, error);
    for (; !error && entry != std::filesystem::recursive_directory_iterator(); entry.increment(error)) {
        if (entry.depth() >= deepest) entry.disable_recursion_pending();
        const std::string name = entry->path().filename().string();
        for (const std::string kind : {"ttyACM", "hidraw"})
            if (name.starts_with(kind) && name.size() > kind.size()) nodes.push_back("/dev/" + name);
    }
    // Serial before HID, where a device offers both: that is what its driver opens.
    std::ranges::sort(nodes, std::ranges::greater());
    return nodes.empty() ? "" : nodes.front();
}

}  // namespace

std::vector<UsbDevice> find_usb_devices(const Machine& machine) {
    const std::filesystem::path bus = "/sys/bus/usb/devices";
    std::vector<std::filesystem::path> ports;
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator(in_root(machine, bus), error))
        ports.push_back(entry.path().filename());
    std::ranges::sort(ports);
    std::vector<UsbDevice> devices;
    for (const auto& port : ports) {
        const std::string vendor = text_of(machine, bus / port / "idVendor").value_or("");
        const std::string product = text_of(machine, bus / port / "idProduct").value_or("");
        if (vendor != "2988" && !(vendor == "0301" && product == "2988")) continue;
        UsbDevice device{vendor + ":" + product, node_below(in_root(machine, bus / port)), false};
        device.may_use =
            !device.node.empty() && access(in_root(machine, device.node).c_str(), R_OK | W_OK) == 0;
        devices.push_back(device);
    }
    return devices;
}

}  // namespace palpate::doctor
