// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "runtime/devices/device_model.hpp"
#include "runtime/devices/dynamics/dynamic_device.hpp"
#include "runtime/devices/hand_path.hpp"
#include "tests/runtime/devices/openhaptics/hd_library/hd_types.hpp"

namespace palpate::hd {

/// What can go wrong with a device; README.md says how each shows.
enum class Trouble {
    warm_motors,
    comm_error,
    disconnect,
    not_a_number,
    frozen_pose,
    max_force,
    velocity,
    impulse,
    timer_error,
    calibration_lost,
    frame_failure,
    scheduler_stall,
};

/// Half open, s of the device's time.
struct Span {
    double from = 0;
    double until = std::numeric_limits<double>::infinity();
    bool contains(double time) const noexcept { return time >= from && time < until; }
};

struct TroubleSpan {
    Trouble trouble;
    Span span;
};

struct ButtonSpan {
    unsigned button = 0;  ///< 0 ... 31
    Span span;
};

struct DeviceScript {
    std::string name = "Default Device";
    devices::DeviceModel model = devices::find_device_model("touch");
    std::optional<devices::HandImpedance> hand = devices::HandImpedance{};  ///< none: a rigid one
    devices::HandPath path = devices::HandPath({{0, Eigen::Vector3d::Zero()}});
    std::array<double, 3> shaft{0, 0, 1};  ///< unit, frame D
    std::vector<ButtonSpan> buttons{};
    bool in_inkwell = false;
    CalibrationState calibration = calibration_ok;
    unsigned styles = style_auto;
    std::vector<TroubleSpan> troubles{};
    unsigned refusal = success;  ///< what hdInitDevice answers instead of opening
};

struct Script {
    bool virtual_clock = false;
    std::int64_t pause_after_ticks = std::numeric_limits<std::int64_t>::max();
    int rate_hz = 1000;               ///< 500 or 1000
    unsigned rate_refusal = success;  ///< what hdSetSchedulerRate answers, whatever the rate
    std::vector<DeviceScript> devices{DeviceScript{}};
};

/// Reads the JSON of README.md. Throws InvalidInput.
Script parse_script(const std::string& json);

}  // namespace palpate::hd
