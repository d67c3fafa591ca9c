// SPDX-License-Identifier: Apache-2.0
#include "runtime/devices/openhaptics/hd_error.hpp"

#include <algorithm>
#include <cstdio>
#include <utility>

namespace palpate::devices {
namespace {

using namespace hdapi;

constexpr const char* report = "report it with the output of 'palpate doctor --json -'";

constexpr std::array<HdErrorText, 21> texts{{
    {invalid_enum, "HD_INVALID_ENUM", "the driver does not know what it was asked for",
     "install a newer OpenHaptics and device driver", no_fault},
    {invalid_value, "HD_INVALID_VALUE", "the driver does not take a value that it was given",
     "check the device's name against those that the driver's setup program lists", no_fault},
    {invalid_operation, "HD_INVALID_OPERATION", "the driver does not do this at this time",
     "close other programs that use the device", no_fault},
    {invalid_input_type, "HD_INVALID_INPUT_TYPE", "the driver keeps this value as another type",
     "install a newer OpenHaptics and device driver", no_fault},
    {bad_handle, "HD_BAD_HANDLE", "the driver does not know the device any more",
     "plug the device in again and start again", device_lost},
    {warm_motors, "HD_WARM_MOTORS", "the device's motors are too warm", "let them cool down", motors_warm},
    {exceeded_max_force, "HD_EXCEEDED_MAX_FORCE", "the force is above what the device bears",
     "lower max_force_n in the case", device_refused},
    {exceeded_max_force_impulse, "HD_EXCEEDED_MAX_FORCE_IMPULSE",
     "the force rises faster than the device bears", "lower max_force_rate_n_per_ms in the case",
     device_refused},
    {exceeded_max_velocity, "HD_EXCEEDED_MAX_VELOCITY", "the device moves too fast", "move more slowly",
     device_refused},
    {force_error, "HD_FORCE_ERROR", "the device cannot render the force",
     "let go of the stylus, then lower max_force_n in the case", device_refused},
    {device_fault, "HD_DEVICE_FAULT", "the device is not there or has failed",
     "check its power and cable; check that the driver's setup program shows it", device_lost},
    {device_already_initiated, "HD_DEVICE_ALREADY_INITIATED", "the device is open already",
     "name each device once, and close other programs that use it", no_fault},
    {comm_error, "HD_COMM_ERROR", "the driver cannot talk to the device",
     "check power and cable; permit access to it with a udev rule for USB vendor 2988 (MODE=\"0666\" on its "
     "/dev/ttyACM or /dev/hidraw), then plug it in again",
     device_lost},
    {comm_config_error, "HD_COMM_CONFIG_ERROR",
     "the driver has no configuration of this name, or one that does not fit the device, or a program that "
     "used it was killed",
     "check the name; unplug the device, plug it in again, and run the driver's setup program as this user "
     "(not with sudo); "
     "GTDD_HOME names the folder that has config/<device>.config",
     device_lost},
    {timer_error, "HD_TIMER_ERROR", "the driver's servo cannot keep its rate",
     "close other programs, or permit real-time priority: 'palpate doctor' says how", tick_late},
    {illegal_begin, "HD_ILLEGAL_BEGIN", "a frame was begun out of turn", report, device_lost},
    {illegal_end, "HD_ILLEGAL_END", "a frame was ended out of turn", report, device_lost},
    {frame_error, "HD_FRAME_ERROR", "the driver could not exchange a frame with the device",
     "check its cable, and plug it into a USB port of its own", device_lost},
    {invalid_priority, "HD_INVALID_PRIORITY", "the scheduler does not take this priority", report, no_fault},
    {scheduler_full, "HD_SCHEDULER_FULL", "the scheduler takes no more callbacks",
     "start again; close what else this process runs on the device", no_fault},
    {invalid_licence, "HD_INVALID_LICENSE", "OpenHaptics finds no licence for this program",
     "install a licence of 3D Systems, or OpenHaptics' Developer Edition, which needs none for use that is "
     "not commercial",
     no_fault},
}};

std::string hex(unsigned code) {
    std::array<char, 16> text{};
    std::snprintf(text.data(), text.size(), "0x%x", code);
    return text.data();
}

}  // namespace

std::span<const HdErrorText> hd_error_texts() {
    return texts;
}

const HdErrorText* find_hd_error(unsigned code) noexcept {
    const auto found = std::ranges::find(texts, code, &HdErrorText::code);
    return found == texts.end() ? nullptr : &*found;
}

ErrorDetail explain_hd_error(const std::string& culprit, const HdErrorInfo& error) {
    const HdErrorText* text = find_hd_error(error.code);
    if (!text)
        return {culprit, "error " + hex(error.code) + ", which HDAPI does not define", "",
                "install a newer OpenHaptics and device driver"};
    return {culprit,
            std::string(text->cause) + " (" + text->name + ", " + hex(error.code) +
                ", the driver's own code " + std::to_string(error.internal_code) + ")",
            "", text->fix};
}

HdErrorInfo take_hd_errors(const HdApi& api) noexcept {
    const HdErrorInfo first = api.get_error();
    HdErrorInfo error = first;
    for (int i = 1; i < most_hd_errors && error.code != success; ++i) error = api.get_error();
    return first;
}

void HdErrorSorter::add(HdHandle device) {
    if (count_ == most_devices)
        throw InvalidInput({"devices", "more than " + std::to_string(most_devices),
                            std::to_string(most_devices) + " at most", ""});
    kept_[count_++].device = device;
}

void HdErrorSorter::drain() noexcept {
    for (int i = 0; i < most_hd_errors; ++i) {
        const HdErrorInfo error = api_.get_error();
        if (error.code == success) return;
        const HdErrorText* text = find_hd_error(error.code);
        const std::uint32_t fault = text ? text->fault : device_lost;  // what nobody knows is no good sign
        const auto devices = std::span(kept_).first(count_);
        const bool known = std::ranges::find(devices, error.device, &Kept::device) != devices.end();
        for (Kept& kept : devices)
            if (!known || kept.device == error.device) kept.faults |= fault;
    }
}

std::uint32_t HdErrorSorter::take(HdHandle device) noexcept {
    for (Kept& kept : std::span(kept_).first(count_))
        if (kept.device == device) return std::exchange(kept.faults, no_fault);
    return no_fault;
}

}  // namespace palpate::devices
