// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <map>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "formats/model/body.hpp"
#include "runtime/devices/device_model.hpp"
#include "runtime/session/watch/fault_log.hpp"

namespace palpate::experiments {

/// A fault that is made to happen, from the first to before the last of these ticks.
struct Injection {
    Fault fault = no_fault;
    std::int64_t from = 0, until = 0;
};

/// Draws faults of all kinds but invalid_force and collision_stale, 1 ms to 2 s long and 1.2 to 20 s after
/// the one before, for a run of `ticks`. A pause of the servo lasts for one tick and skips 10 to 2000.
std::vector<Injection> draw_injections(std::int64_t ticks, std::mt19937_64& random);

/// What a run with faults found. Counts are of ticks unless said otherwise.
struct FaultRun {
    std::int64_t ticks = 0, pressing = 0;
    std::map<std::string, std::int64_t> injected;  ///< faults by name
    std::int64_t reported = 0;                     ///< faults
    std::int64_t missed = 0, unexpected = 0;  ///< faults not reported in their first tick; reports of none
    std::int64_t above_limit = 0, above_slew = 0, not_finite = 0;
    std::int64_t not_gone = 0;  ///< with force 20 ticks after a fault began, while it lasts
    double strongest = 0;       ///< N
    double largest_step = 0;    ///< N from tick to tick
    double largest_growth = 0;  ///< N from tick to tick, of a force that comes back

    void add(const FaultRun& other);
};

/// Pushes, slides and leaves for `ticks` virtual ticks with a simulated device in a hand that gives way, at a
/// place and by a path drawn from `random`, while `injections` happen. A device that is lost stays where it
/// was, one without calibration is off by 50 mm, a position that is not a number has one NaN; all as a device
/// tells them. The window's and the asset's faults are told as their watchers do.
FaultRun run_with_faults(const Case& patient_case, std::string_view method,
                         const devices::DeviceModel& device, const std::vector<Injection>& injections,
                         std::int64_t ticks, std::mt19937_64& random);

}  // namespace palpate::experiments
