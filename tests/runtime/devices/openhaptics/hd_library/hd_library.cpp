// SPDX-License-Identifier: Apache-2.0
#include "tests/runtime/devices/openhaptics/hd_library/hd_library.hpp"

#include <algorithm>

namespace palpate::hd {
namespace {

// What the devices do in each tick of the servo.
TickHooks hooks_of(Library& library) {
    const auto for_each = [&library](auto&& action) {
        const std::lock_guard lock(library.mutex);
        for (Handle handle = 0; handle < library.open.size(); ++handle)
            if (HdDevice* device = library.open[handle].get()) action(*device, handle);
    };
    return {
        .begin =
            [&library, for_each](double time) {
                for_each([&](HdDevice& device, Handle handle) {
                    library.report(device.begin_tick(time), handle);
                });
            },
        .end =
            [&library, for_each] {
                for_each([&](HdDevice& device, Handle handle) { library.report(device.end_tick(), handle); });
            },
        .stalled_until =
            [for_each](double time) {
                double until = time;
                for_each(
                    [&](HdDevice& device, Handle) { until = std::max(until, device.stalled_until(time)); });
                return until;
            }};
}

}  // namespace

Library& library() {
    static Library instance;
    return instance;
}

void Library::configure(Script new_script) {
    const std::lock_guard lock(mutex);
    script = std::move(new_script);
    open.clear();
    current = invalid_handle;
    errors.clear();
    scheduler.set_rate(script.rate_hz);
    scheduler.configure(script.virtual_clock, script.pause_after_ticks, hooks_of(*this));
    configured = true;
}

HdDevice* Library::find(Handle handle) noexcept {
    return handle < open.size() ? open[handle].get() : nullptr;
}

HdDevice* Library::require_current() noexcept {
    HdDevice* device = find(current);
    if (!device) report(bad_handle, current);
    return device;
}

}  // namespace palpate::hd
