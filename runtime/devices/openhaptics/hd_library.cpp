// SPDX-License-Identifier: Apache-2.0
#include "runtime/devices/openhaptics/hd_library.hpp"

#include <array>
#include <cstdlib>
#include <dlfcn.h>
#include <map>
#include <mutex>
#include <optional>

namespace palpate::devices {
namespace {

// OpenHaptics 3.4 and later, any with its development link, 3.0.
constexpr std::array<const char*, 3> known_names{"libHD.so.3.4", "libHD.so", "libHD.so.3.0"};

constexpr const char* get_driver =
    "install OpenHaptics for Linux and the device's driver from 3D Systems, or give the library's path in "
    "PALPATE_HD_LIBRARY; without a device, use a simulated one";

constexpr const char* check_path =
    "check the path; without one, libHD.so.3.4, libHD.so and libHD.so.3.0 are tried where the loader looks";

struct Dependency {
    const char* start;  // of the missing file's name
    const char* fix;
};
constexpr std::array<Dependency, 4> dependencies{{
    {"libncurses.so.5", "install Debian's package libncurses5 (dropped after Debian 12)"},
    {"libtinfo.so.5", "install Debian's package libtinfo5 (dropped after Debian 12)"},
    {"libPHANToMIO.so",
     "install the Phantom Device Drivers that came with OpenHaptics 3.0, then run 'sudo ldconfig'"},
    {"libPhantomIOLib42.so", "install the Touch device driver of 3D Systems, then run 'sudo ldconfig'"},
}};

bool contains(const std::string& text, const char* part) {
    return text.find(part) != std::string::npos;
}

// The file that the loader looked for and did not find; empty if that is not what `message` says.
std::string missing_file(const std::string& message) {
    if (!contains(message, "No such file or directory")) return {};
    return message.substr(0, message.find(':'));
}

template <class Function>
void bind(void* library, const std::string& name, const char* symbol, Function*& function) {
    function = reinterpret_cast<Function*>(dlsym(library, symbol));
    if (!function)
        throw InvalidInput({name, std::string("it has no function ") + symbol,
                            "OpenHaptics' HDAPI library, version 3.0 or later",
                            "give the path of libHD.so in PALPATE_HD_LIBRARY"});
}

HdApi bind_all(void* library, const std::string& name) {
    HdApi api{};
    bind(library, name, "hdInitDevice", api.init_device);
    bind(library, name, "hdDisableDevice", api.disable_device);
    bind(library, name, "hdMakeCurrentDevice", api.make_current_device);
    bind(library, name, "hdBeginFrame", api.begin_frame);
    bind(library, name, "hdEndFrame", api.end_frame);
    bind(library, name, "hdGetError", api.get_error);
    bind(library, name, "hdEnable", api.enable);
    bind(library, name, "hdDisable", api.disable);
    bind(library, name, "hdGetIntegerv", api.get_integers);
    bind(library, name, "hdGetDoublev", api.get_doubles);
    bind(library, name, "hdGetString", api.get_string);
    bind(library, name, "hdSetDoublev", api.set_doubles);
    bind(library, name, "hdCheckCalibration", api.check_calibration);
    bind(library, name, "hdUpdateCalibration", api.update_calibration);
    bind(library, name, "hdStartScheduler", api.start_scheduler);
    bind(library, name, "hdStopScheduler", api.stop_scheduler);
    bind(library, name, "hdSetSchedulerRate", api.set_scheduler_rate);
    bind(library, name, "hdScheduleAsynchronous", api.schedule_asynchronous);
    bind(library, name, "hdUnschedule", api.unschedule);
    return api;
}

// Loads and keeps. Symbols stay local to the library: it needs no more (Python's ctypes loads it so in
// pyOpenHaptics), and two libraries in one process cannot mix. Returns what dlerror() says if it fails.
std::optional<std::string> load(const std::string& name, const HdApi*& api) {
    static std::mutex mutex;
    static std::map<std::string, HdApi> loaded;
    const std::lock_guard lock(mutex);
    if (const auto found = loaded.find(name); found != loaded.end()) {
        api = &found->second;
        return std::nullopt;
    }
    void* library = dlopen(name.c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
    if (!library) return dlerror();
    api = &loaded.emplace(name, bind_all(library, name)).first->second;
    return std::nullopt;
}

}  // namespace

std::span<const char* const> hd_library_names() {
    return known_names;
}

ErrorDetail explain_load_error(const std::string& library, const std::string& message) {
    const std::string missing = missing_file(message);
    if (missing == library)
        return {library, "not found", "", contains(library, "/") ? check_path : get_driver};
    for (const Dependency& dependency : dependencies)
        if (missing.starts_with(dependency.start))
            return {library, "it needs " + missing + ", which is not installed", "", dependency.fix};
    if (!missing.empty())
        return {library, "it needs " + missing + ", which is not installed", "",
                "install the package that has it ('apt-file search " + missing +
                    "'), or put its folder into LD_LIBRARY_PATH"};
    if (contains(message, "wrong ELF class"))
        return {library, "it is a 32-bit library", "a 64-bit one",
                "give the path of the 64-bit libHD.so in PALPATE_HD_LIBRARY"};
    if (contains(message, "undefined symbol"))
        return {library, "it does not fit the driver installed (" + message + ")", "",
                "install OpenHaptics and the device driver of the same release"};
    if (contains(message, "Permission denied"))
        return {library, "it may not be read", "", "permit it with 'sudo chmod a+rx' on the library"};
    if (contains(message, "invalid ELF header") || contains(message, "file too short"))
        return {library, "it is not a shared library (" + message + ")", "", get_driver};
    return {library, message, "", get_driver};
}

const HdApi& load_hd_library(const std::filesystem::path& user_path) {
    const HdApi* api = nullptr;
    std::string name = user_path.string();
    if (const char* variable = std::getenv(hd_library_variable); name.empty() && variable) name = variable;
    if (!name.empty()) {
        if (const auto message = load(name, api)) throw InvalidInput(explain_load_error(name, *message));
        return *api;
    }
    // That one is there and cannot be loaded says more than that others are not there.
    std::optional<ErrorDetail> unusable;
    for (const char* known : known_names) {
        const auto message = load(known, api);
        if (!message) return *api;
        if (missing_file(*message) != known && !unusable) unusable = explain_load_error(known, *message);
    }
    if (unusable) throw SystemFailure(*unusable);
    throw SystemFailure(
        {"OpenHaptics", "its library is not found", "libHD.so.3.4, libHD.so or libHD.so.3.0", get_driver});
}

}  // namespace palpate::devices
