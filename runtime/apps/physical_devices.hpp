// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "runtime/devices/openhaptics/hd_session.hpp"
#include "runtime/openigtlink/address.hpp"
#include "runtime/realtime/device.hpp"
#include "runtime/realtime/servo.hpp"

namespace palpate {

/// A device that is not simulated, as --device names it: "openhaptics", "openhaptics:NAME" or
/// "openhaptics:NAME,NAME" for devices of one driver, one tool each; "igtl:HOST:PORT" or
/// "igtl:HOST:PORT/NAME" for a tracked tool.
struct PhysicalDevice {
    std::vector<std::string> driver_names;  ///< of OpenHaptics; empty: the default device
    std::optional<TrackerAddress> tracker;  ///< there: not of OpenHaptics
    std::size_t tool_count() const { return driver_names.empty() ? 1 : driver_names.size(); }
};

/// Nothing if `text` begins with neither "openhaptics" nor "igtl:". Throws UsageError for a name that is
/// empty or an address that is none.
std::optional<PhysicalDevice> parse_physical_device(std::string_view text);

/// Opened devices, one for each tool, seen from the patient.
class PhysicalDevices {
  public:
    /// Opens them. Devices of OpenHaptics are turned by R_PD and stand with the middle of their workspace at
    /// `start` (p_P, mm), several at one place, so that all reach what one does; a tracker tells of the
    /// patient's frame. Throws InvalidInput or SystemFailure with cause and fix.
    PhysicalDevices(const PhysicalDevice& device, const Eigen::Vector3d& start, const Eigen::Matrix3d& R_PD);

    std::vector<Device*> devices() const;
    /// The driver's; null where the loop's own will do.
    Servo* servo() const { return driver_ ? &driver_->servo() : nullptr; }

  private:
    std::unique_ptr<HdSession> driver_;  // outlives what stands on it
    std::vector<std::unique_ptr<Device>> devices_;
};

}  // namespace palpate
