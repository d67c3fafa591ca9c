// SPDX-License-Identifier: Apache-2.0
#include "tests/runtime/devices/openhaptics/hd_library/hd_library.hpp"

namespace palpate::hd {
namespace {

unsigned report(unsigned code) {
    Library& lib = library();
    const std::lock_guard lock(lib.mutex);
    lib.report(code, lib.current);
    return code;
}

}  // namespace
}  // namespace palpate::hd

using namespace palpate::hd;

extern "C" void hdStartScheduler() {
    library().scheduler.start();
}

extern "C" void hdStopScheduler() {
    Library& lib = library();
    if (lib.scheduler.in_servo_thread()) {
        report(invalid_operation);
        return;
    }
    lib.scheduler.stop();
    const std::lock_guard lock(lib.mutex);
    for (const auto& device : lib.open)
        if (device) device->power_down();
}

extern "C" void hdSetSchedulerRate(unsigned long rate_hz) {
    Library& lib = library();
    if (lib.script.rate_refusal != success)
        report(lib.script.rate_refusal);
    else if (rate_hz != 500 && rate_hz != 1000)
        report(invalid_value);
    else if (lib.scheduler.running())
        report(invalid_operation);
    else
        lib.scheduler.set_rate(static_cast<int>(rate_hz));
}

extern "C" unsigned long hdScheduleAsynchronous(Callback function, void* data, unsigned short priority) {
    if (!function) {
        report(invalid_value);
        return 0;
    }
    const unsigned long handle = library().scheduler.schedule(function, data, priority);
    if (handle == 0) report(scheduler_full);
    return handle;
}

extern "C" void hdScheduleSynchronous(Callback function, void* data, unsigned short priority) {
    Scheduler& scheduler = library().scheduler;
    if (!function) {
        report(invalid_value);
    } else if (!scheduler.running() || scheduler.in_servo_thread()) {
        while (function(data) == callback_continue) {
        }
    } else if (const unsigned long handle = scheduler.schedule(function, data, priority); handle != 0) {
        scheduler.wait_for(handle);
        scheduler.unschedule(handle);  // where the servo was stopped meanwhile
    } else {
        report(scheduler_full);
    }
}

extern "C" void hdUnschedule(unsigned long handle) {
    if (!library().scheduler.unschedule(handle)) report(invalid_operation);
}

extern "C" unsigned char hdWaitForCompletion(unsigned long handle, unsigned wait) {
    Scheduler& scheduler = library().scheduler;
    if (wait > 1) {
        report(invalid_value);
        return 0;
    }
    if (wait == 0) return scheduler.is_scheduled(handle) ? 1 : 0;
    if (!scheduler.running() || scheduler.in_servo_thread()) {
        report(invalid_operation);
        return 0;
    }
    scheduler.wait_for(handle);
    return scheduler.is_scheduled(handle) ? 0 : 1;
}

extern "C" double hdGetSchedulerTimeStamp() {
    return library().scheduler.since_tick();
}
