// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <atomic>
#include <string>
#include <vector>

#include "runtime/devices/openhaptics/hd_api.hpp"

namespace palpate {

/// What stands behind one handle of the fake driver.
struct FakeHdDevice {
    bool open = false, force_output = false, in_frame = false;
    std::array<double, 3> position{0, 0, 0}, joint_angles{0.1, 0.2, 0.3}, force{0, 0, 0};
    std::array<double, 3> torque{0, 0, 0};
    int output_dof = 3;
    bool takes_torque = true;
    std::array<double, 3> stylus{0, 0, 1};                       ///< the transform's third column
    std::array<double, 3> stylus_x{1, 0, 0}, stylus_y{0, 1, 0};  ///< its first two
    int buttons = 0, frames = 0;
    double temperature = 0;
    unsigned calibration = devices::hdapi::calibration_ok;
    bool silent = false;  ///< gives no position, and no error
    int styles = devices::hdapi::automatic;
    int updates = 0;  ///< of its calibration
};

/// A driver with as many devices as there are names, of which a test may change everything. HDAPI's
/// functions take no context, so there is one for the process; reset_fake_hd_driver() makes it anew.
struct FakeHdDriver {
    std::vector<const char*> names{nullptr};  ///< that open; nullptr is the default device
    std::vector<FakeHdDevice> devices;
    std::vector<devices::HdErrorInfo> errors;  ///< the latest last
    std::vector<std::string> asked;            ///< names that were asked for, "NULL" for the null pointer
    unsigned unknown_name = devices::hdapi::comm_config_error;
    unsigned rate_error = devices::hdapi::success, start_error = devices::hdapi::success,
             enable_error = devices::hdapi::success;
    bool ticks = true;
    int gap_after_tick = 0, gap_ms = 0;  ///< the scheduler stands still after so many ticks, for so long
    std::atomic<bool> runs{false};
    devices::HdHandle current = devices::hdapi::invalid_handle;
};

FakeHdDriver& fake_hd_driver();
void reset_fake_hd_driver(std::vector<const char*> names = {nullptr});
const devices::HdApi& fake_hd_api();

}  // namespace palpate
