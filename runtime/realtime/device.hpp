// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <string>

namespace palpate {

/// What a device reports once per tick.
struct DeviceState {
    double time = 0;                          ///< s since the loop started
    std::array<double, 3> position{0, 0, 0};  ///< of the tool's centre, p_P, mm
    std::array<double, 3> shaft{0, 0, 0};     ///< unit, from the tip along the tool's shaft; zero: not known
    std::uint32_t buttons = 0;                ///< one bit each
    bool connected = true;                    ///< false: the position is not to be trusted
};

/// What a device can render.
struct DeviceLimits {
    double max_force = 0;      ///< N
    double max_stiffness = 0;  ///< N/mm
    double damping = 0;        ///< of the device itself, N s/mm; 0: not known
};

/// A haptic device as the servo loop sees it. read() and write() are called by the haptic thread alone, never
/// allocate, lock or throw.
class Device {
  public:
    virtual ~Device() = default;
    virtual std::string name() const = 0;
    virtual DeviceLimits limits() const = 0;
    /// Reads the state at loop time `time` (s); a physical device ignores the argument and reads its
    /// encoders.
    virtual DeviceState read(double time) noexcept = 0;
    /// Renders `force` (N, frame P) until the next call.
    virtual void write(const std::array<double, 3>& force) noexcept = 0;
};

}  // namespace palpate
