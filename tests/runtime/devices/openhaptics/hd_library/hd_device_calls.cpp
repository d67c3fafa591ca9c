// SPDX-License-Identifier: Apache-2.0
// Devices, frames, calibration, errors, and what configures the library.
#include <algorithm>
#include <clocale>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iostream>
#include <iterator>
#include <string>
#include <unistd.h>

#include "formats/model/errors.hpp"
#include "tests/runtime/devices/openhaptics/hd_library/hd_library.hpp"

namespace palpate::hd {
namespace {

// Drivers have been seen to fail once their library has been unloaded and loaded again.
constexpr const char* unloaded_mark = "PALPATE_HD_UNLOADED_IN";

__attribute__((destructor)) void leave_mark() {
    setenv(unloaded_mark, std::to_string(getpid()).c_str(), 1);
}

bool loaded_again() {
    const char* mark = std::getenv(unloaded_mark);
    return mark && mark == std::to_string(getpid());
}

// The file that PALPATE_HD_SCRIPT names, unless the script was given already.
bool configure_from_environment(Library& lib) try {
    if (lib.configured) return true;
    Script script;
    if (const char* file = std::getenv("PALPATE_HD_SCRIPT")) {
        std::ifstream stream(file);
        if (!stream) throw InvalidInput({file, "cannot be read", "", "check PALPATE_HD_SCRIPT"});
        script = parse_script({std::istreambuf_iterator<char>(stream), {}});
    }
    lib.configure(std::move(script));
    return true;
} catch (const Error& error) {
    std::cerr << "conformance library: " << error.what() << '\n';
    return false;
}

const DeviceScript* script_of(const Library& lib, const char* name) {
    if (!name) return lib.script.devices.empty() ? nullptr : &lib.script.devices.front();
    const auto found = std::ranges::find(lib.script.devices, name, &DeviceScript::name);
    return found == lib.script.devices.end() ? nullptr : &*found;
}

bool is_open(const Library& lib, const std::string& name) {
    return std::ranges::any_of(lib.open,
                               [&](const auto& device) { return device && device->script().name == name; });
}

// Why a device is not opened; success if it may be.
unsigned refusal_of(const Library& lib, const DeviceScript* script) {
    if (loaded_again()) return device_fault;
    // A driver that reads its configuration with a comma for the decimal point gets it wrong.
    if (std::strcmp(std::localeconv()->decimal_point, ".") != 0) return comm_config_error;
    if (!script) return comm_config_error;
    if (script->refusal != success) return script->refusal;
    return is_open(lib, script->name) ? unsigned{already_initiated} : unsigned{success};
}

// Reports what `action` answers for a device.
template <class Action>
void with_device(Handle handle, Action&& action) {
    Library& lib = library();
    const std::lock_guard lock(lib.mutex);
    HdDevice* device = lib.find(handle);
    lib.report(device ? action(lib, *device) : bad_handle, handle);
}

}  // namespace
}  // namespace palpate::hd

using namespace palpate::hd;

extern "C" Handle hdInitDevice(const char* name) {
    Library& lib = library();
    if (!configure_from_environment(lib)) {
        lib.report(comm_config_error, invalid_handle);
        return invalid_handle;
    }
    const std::lock_guard lock(lib.mutex);
    const DeviceScript* script = script_of(lib, name);
    if (const unsigned refusal = refusal_of(lib, script); refusal != success) {
        lib.report(refusal, invalid_handle);
        return invalid_handle;
    }
    lib.open.push_back(std::make_unique<HdDevice>(*script, 1.0 / lib.scheduler.rate_hz()));
    lib.current = static_cast<Handle>(lib.open.size() - 1);
    return lib.current;
}

extern "C" void hdDisableDevice(Handle handle) {
    with_device(handle, [handle](Library& lib, HdDevice&) {
        lib.open[handle].reset();
        if (lib.current == handle) lib.current = invalid_handle;
        return success;
    });
}

extern "C" void hdMakeCurrentDevice(Handle handle) {
    with_device(handle, [handle](Library& lib, HdDevice&) {
        lib.current = handle;
        return success;
    });
}

extern "C" Handle hdGetCurrentDevice() {
    const std::lock_guard lock(library().mutex);
    return library().current;
}

extern "C" void hdBeginFrame(Handle handle) {
    with_device(handle, [handle](Library& lib, HdDevice& device) {
        lib.current = handle;
        return device.begin_frame(lib.scheduler.running());
    });
}

extern "C" void hdEndFrame(Handle handle) {
    with_device(handle, [](Library&, HdDevice& device) { return device.end_frame(); });
}

extern "C" ErrorInfo hdGetError() {
    const std::lock_guard lock(library().mutex);
    return library().errors.pop();
}

extern "C" const char* hdGetErrorString(unsigned code) {
    return error_text(code);
}

extern "C" unsigned hdCheckCalibration() {
    const std::lock_guard lock(library().mutex);
    const HdDevice* device = library().require_current();
    return device ? device->check_calibration() : calibration_needs_manual_input;
}

extern "C" unsigned hdCheckCalibrationStyle() {
    const std::lock_guard lock(library().mutex);
    const HdDevice* device = library().require_current();
    return device ? device->script().styles : 0;
}

extern "C" void hdUpdateCalibration(unsigned style) {
    with_device(hdGetCurrentDevice(),
                [style](Library&, HdDevice& device) { return device.update_calibration(style); });
}

/// Not HDAPI: stops the servo, closes every device and takes on the script (README.md). Returns 0, or a
/// message that stays until the next call.
extern "C" const char* palpate_hd_configure(const char* json) {
    static std::string message;
    try {
        Script script = parse_script(json);
        library().scheduler.stop();
        library().configure(std::move(script));
        return nullptr;
    } catch (const palpate::Error& error) {
        message = error.what();
        return message.c_str();
    }
}

/// Not HDAPI: what stands at the hardware's side of a device; zeros if it is not open.
extern "C" Hardware palpate_hd_hardware(Handle handle) {
    const std::lock_guard lock(library().mutex);
    const HdDevice* device = library().find(handle);
    return device ? device->hardware() : Hardware{};
}
