// SPDX-License-Identifier: Apache-2.0
#include "tests/runtime/devices/openhaptics/fake_hd_driver.hpp"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <memory>
#include <thread>

namespace palpate {
namespace {

using namespace devices;
using namespace hdapi;

std::unique_ptr<FakeHdDriver> driver;
std::thread scheduler;
std::atomic<bool> stopping{false};

void fail(unsigned code) {
    if (code != success) driver->errors.push_back({code, 0, driver->current});
}

FakeHdDevice& current() {
    return driver->devices.at(driver->current);
}

HdHandle init_device(const char* name) {
    driver->asked.push_back(name ? name : "NULL");
    for (std::size_t i = 0; i < driver->names.size(); ++i) {
        const char* known = driver->names[i];
        if (known != name && !(known && name && std::strcmp(known, name) == 0)) continue;
        driver->devices[i].open = true;
        return driver->current = static_cast<HdHandle>(i);
    }
    fail(driver->unknown_name);
    return invalid_handle;
}

void begin_frame(HdHandle device) {
    driver->current = device;
    if (current().in_frame) fail(illegal_begin);
    current().in_frame = true;
}

void end_frame(HdHandle device) {
    if (!driver->devices.at(device).in_frame) fail(illegal_end);
    driver->devices[device].in_frame = false;
    ++driver->devices[device].frames;
}

HdErrorInfo get_error() {
    if (driver->errors.empty()) return {success, 0, invalid_handle};
    const HdErrorInfo latest = driver->errors.back();
    driver->errors.pop_back();
    return latest;
}

void get_integers(unsigned parameter, int* values) {
    if (parameter == current_buttons)
        *values = current().buttons;
    else if (parameter == calibration_style)
        *values = current().styles;
    else if (parameter == output_dof)
        *values = current().output_dof;
    else if (parameter == update_rate)
        *values = 1000;
    else
        fail(invalid_enum);
}

void get_doubles(unsigned parameter, double* values) {
    const FakeHdDevice& device = current();
    if (parameter == current_position && device.silent) return;
    if (parameter == current_position)
        std::ranges::copy(device.position, values);
    else if (parameter == current_joint_angles)
        std::ranges::copy(device.joint_angles, values);
    else if (parameter == current_transform) {
        std::ranges::copy(device.stylus_x, values);
        std::ranges::copy(device.stylus_y, values + 4);
        std::ranges::copy(device.stylus, values + 8);
    } else if (parameter == motor_temperature)
        values[1] = device.temperature;  // of its second motor
    else if (parameter == nominal_max_force)
        *values = 3.3;
    else if (parameter == nominal_max_torque && device.output_dof == 6)
        *values = 170;
    else
        fail(invalid_enum);
}

void set_doubles(unsigned parameter, const double* values) {
    FakeHdDevice& device = current();
    if (!device.in_frame) return fail(invalid_operation);
    if (parameter == current_force)
        std::copy_n(values, 3, device.force.begin());
    else if (parameter == current_torque && device.takes_torque)
        std::copy_n(values, 3, device.torque.begin());
    else
        fail(invalid_enum);
}

// Calls `callback` as often as the thread gets to it: nothing here depends on the clock but the gap.
HdOperation schedule(HdCallback callback, void* data, unsigned short) {
    if (!driver->ticks) return 1;
    stopping = false;
    scheduler = std::thread([=] {
        for (int tick = 1; !stopping && callback(data) == callback_continue; ++tick)
            if (tick == driver->gap_after_tick)
                std::this_thread::sleep_for(std::chrono::milliseconds(driver->gap_ms));
    });
    return 1;
}

void unschedule(HdOperation) {
    stopping = true;
    if (scheduler.joinable()) scheduler.join();
}

}  // namespace

FakeHdDriver& fake_hd_driver() {
    return *driver;
}

void reset_fake_hd_driver(std::vector<const char*> names) {
    driver = std::make_unique<FakeHdDriver>();
    driver->devices.resize(names.size());
    driver->names = std::move(names);
}

const HdApi& fake_hd_api() {
    static const HdApi api{
        .init_device = init_device,
        .disable_device = [](HdHandle device) { driver->devices.at(device).open = false; },
        .make_current_device = [](HdHandle device) { driver->current = device; },
        .begin_frame = begin_frame,
        .end_frame = end_frame,
        .get_error = get_error,
        .enable =
            [](unsigned) {
                current().force_output = driver->enable_error == success;
                fail(driver->enable_error);
            },
        .disable = [](unsigned) { current().force_output = false; },
        .get_integers = get_integers,
        .get_doubles = get_doubles,
        .get_string = [](unsigned parameter) { return parameter == device_model_type ? "Fake" : nullptr; },
        .set_doubles = set_doubles,
        .check_calibration = [] { return current().calibration; },
        .update_calibration =
            [](unsigned) {
                ++current().updates;
                current().calibration = calibration_ok;
            },
        .start_scheduler =
            [] {
                driver->runs = true;
                fail(driver->start_error);
            },
        .stop_scheduler = [] { driver->runs = false; },
        .set_scheduler_rate = [](unsigned long) { fail(driver->rate_error); },
        .schedule_asynchronous = schedule,
        .unschedule = unschedule,
    };
    return api;
}

}  // namespace palpate
