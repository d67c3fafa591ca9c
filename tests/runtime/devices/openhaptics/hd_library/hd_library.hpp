// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <mutex>
#include <vector>

#include "tests/runtime/devices/openhaptics/hd_library/hd_device.hpp"
#include "tests/runtime/devices/openhaptics/hd_library/hd_errors.hpp"
#include "tests/runtime/devices/openhaptics/hd_library/hd_scheduler.hpp"

namespace palpate::hd {

/// All that the C interface stands on, once a process. `mutex` guards everything but the scheduler, which
/// guards itself; it is never held while a callback runs.
struct Library {
    std::mutex mutex;
    Script script;
    bool configured = false;
    std::vector<std::unique_ptr<HdDevice>> open;  ///< by handle; empty where a device was closed
    Handle current = invalid_handle;
    ErrorStack errors;
    Scheduler scheduler;

    /// Closes every device and starts anew. The servo must be stopped.
    void configure(Script new_script);

    /// The device of a handle, or null; the rest with `mutex` held.
    HdDevice* find(Handle handle) noexcept;
    void report(unsigned code, Handle device) noexcept { errors.push(code, device); }
    /// The current device; reports bad_handle and gives null where there is none.
    HdDevice* require_current() noexcept;
};

Library& library();

}  // namespace palpate::hd
