// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "runtime/devices/hand_path.hpp"
#include "runtime/realtime/device.hpp"
#include "runtime/realtime/servo.hpp"

namespace palpate::devices {

/// How a device stands in the patient.
struct DevicePlace {
    Eigen::Vector3d start{0, 0, 0};                      ///< p_P, mm, of its workspace's middle
    Eigen::Matrix3d R_PD = Eigen::Matrix3d::Identity();  ///< how it is turned
};

/// One tool that a device is to hold.
struct HeldTool {
    std::optional<DevicePlace> place;  ///< none: the device speaks of its own frame D, not of P
    std::array<double, 3> shaft{0, 0,
                                0};  ///< frame P, of simulated devices, which do not turn: see DeviceState
    std::optional<HandPath> path{};  ///< what a simulated hand does, frame P; none: it is guided
    /// How a guided hand holds it first, R_PT; zero: nobody says.
    Eigen::Quaterniond orientation{0, 0, 0, 0};
};

/// What is asked of devices of one kind.
struct DeviceRequest {
    std::vector<HeldTool> tools;  ///< one for each device
    DeviceLimits limits;          ///< of a hand of infinite stiffness, which has none of its own
};

/// Devices that are open, one for each tool.
struct OpenDevices {
    std::shared_ptr<void> driver{};  ///< what they stand on; ends after them
    std::vector<std::shared_ptr<realtime::Device>> devices;
    realtime::Servo* servo = nullptr;  ///< the driver's own; null: any will do
    /// Says where mouse and keyboard want a guided hand (p_P, mm) and how it is to hold the tool (R_PT; zero:
    /// as it does), from one thread; empty: nobody is guided.
    std::function<void(const Eigen::Vector3d&, const Eigen::Quaterniond&)> guide{};
};

/// One line of the list of devices: what --device, help texts and errors know of it.
struct DeviceKind {
    std::string name;              ///< "openhaptics"; empty: what is meant where no device is named
    std::string usage;             ///< "openhaptics[:NAME]": its name, and the address that may follow
    std::string usage_of_several;  ///< "openhaptics:NAME,NAME"; empty: no address means several tools
    std::string sentence;          ///< what it is
    bool simulated = false;        ///< a hand of the program's holds it, scripted or guided; else a person's
    bool renders_force = true;
    /// How many tools the address means, which stands after the name and a colon; nothing where it makes no
    /// sense, or UsageError saying why.
    std::function<std::optional<std::size_t>(std::string_view address)> tool_count;
    /// Opens or makes devices for the request's tools. Throws InvalidInput or SystemFailure with cause and
    /// fix.
    std::function<OpenDevices(std::string_view address, const DeviceRequest& request)> open;
};

/// For the kinds that know no address: one tool.
inline std::optional<std::size_t> one_tool_without_address(std::string_view address) {
    return address.empty() ? std::optional<std::size_t>(1) : std::nullopt;
}

}  // namespace palpate::devices
