// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <string>

#include "formats/records/device_limits.hpp"
#include "formats/records/fault.hpp"

namespace palpate::realtime {

/// What a device reports once per tick.
struct DeviceState {
    double time = 0;                          ///< s since the loop started
    std::array<double, 3> position{0, 0, 0};  ///< of the tool's centre, p_D, mm
    std::array<double, 3> shaft{0, 0, 0};     ///< unit, from the tip along the tool's shaft; zero: not known
    /// Unit quaternion (x, y, z, w) of the rotation R_DT from the tool's frame T, whose z axis is the shaft;
    /// zero: not known.
    std::array<double, 4> orientation{0, 0, 0, 0};
    double jaw_angle = -1;            ///< between a forceps' jaws, rad; negative: not known
    std::uint32_t buttons = 0;        ///< one bit each, the lowest for the first
    std::uint32_t faults = no_fault;  ///< Fault flags
};

/// What a device is to do to its tool.
struct Wrench {
    std::array<double, 3> force{0, 0, 0};   ///< N, frame D
    std::array<double, 3> torque{0, 0, 0};  ///< N mm, frame D, about the state's position
};

/// Whether a device knows where it is.
enum class Calibration {
    ok,
    needs_update,       ///< calibrate() brings it up to date
    needs_manual_input  ///< somebody must put the stylus into its inkwell or the arm into its reset position
};

/// A haptic device as the servo loop sees it; it is open from its construction to its end. read() and
/// write() are called by the servo's thread alone, in this order in each tick, and never allocate, lock or
/// throw. The frame D is the device's own; MountedDevice maps it to the patient's, and a simulated device
/// made in the patient's frame has D = P.
class Device {
  public:
    virtual ~Device() = default;
    virtual std::string name() const = 0;
    virtual DeviceLimits limits() const = 0;
    virtual Calibration calibration() { return Calibration::ok; }
    /// Brings the calibration up to date where calibration() is needs_update.
    virtual void calibrate() {}
    /// Reads the state at loop time `time` (s); a physical device ignores the argument and reads its
    /// encoders.
    virtual DeviceState read(double time) noexcept = 0;
    /// Renders `wrench` until the next call; of its torque nothing where limits().max_torque is zero.
    virtual void write(const Wrench& wrench) noexcept = 0;
};

}  // namespace palpate::realtime
