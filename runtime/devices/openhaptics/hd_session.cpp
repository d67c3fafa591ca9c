// SPDX-License-Identifier: Apache-2.0
#include "runtime/devices/openhaptics/hd_session.hpp"

#include <algorithm>
#include <chrono>
#include <clocale>
#include <optional>
#include <thread>

#include "formats/model/errors.hpp"
#include "runtime/devices/openhaptics/hd_device.hpp"
#include "runtime/devices/openhaptics/hd_error.hpp"
#include "runtime/devices/openhaptics/hd_library.hpp"
#include "runtime/devices/openhaptics/hd_servo.hpp"

namespace palpate::devices {
namespace {

using namespace realtime;

constexpr int calibration_attempts = 10;
constexpr std::chrono::milliseconds between_attempts{100};
constexpr std::chrono::milliseconds between_updates{50};

/// The process's numbers in the C locale, until it ends.
class NumbersInC {
  public:
    // NOLINTBEGIN(concurrency-mt-unsafe): the whole process is meant, the driver's own threads too
    NumbersInC() : before_(std::setlocale(LC_NUMERIC, nullptr)) { std::setlocale(LC_NUMERIC, "C"); }
    NumbersInC(const NumbersInC&) = delete;
    NumbersInC& operator=(const NumbersInC&) = delete;
    ~NumbersInC() { std::setlocale(LC_NUMERIC, before_.c_str()); }
    // NOLINTEND(concurrency-mt-unsafe)

  private:
    std::string before_;
};

// The names to open, "" for the default device.
std::vector<std::string> names_of(const HdSettings& settings) {
    if (settings.devices.empty()) return {""};
    for (auto name = settings.devices.begin(); name != settings.devices.end(); ++name) {
        if (name->empty())
            throw InvalidInput({"devices", "an empty name", "names as in the driver's setup program",
                                "leave the list out for the default device"});
        if (std::find(settings.devices.begin(), name, *name) != name)
            throw InvalidInput({"devices", "'" + *name + "' is named twice", "each device once", ""});
    }
    return settings.devices;
}

bool needs_update(HdDevice* device) {
    return device->calibration() == Calibration::needs_update;
}

// Reads the devices, without force, until each knows where it is.
void calibrate(HdServo& servo, std::span<HdDevice* const> devices) {
    const auto look = [&] {
        servo.tick_once([&](const ServoTick& tick) {
            for (HdDevice* device : devices) device->read(tick.time);
            for (HdDevice* device : devices) device->write({});
        });
    };
    look();
    for (int attempt = 0; attempt < calibration_attempts && std::ranges::any_of(devices, needs_update);
         ++attempt) {
        if (attempt > 0) std::this_thread::sleep_for(between_attempts);
        for (HdDevice* device : devices)
            if (needs_update(device)) device->calibrate();
        look();
    }
    for (HdDevice* device : devices)
        if (device->calibration() != Calibration::ok)
            throw SystemFailure({device->name(), "it is not calibrated", "", device->how_to_calibrate()});
}

// Beside the servo: where there is one device, the driver's current device cannot be another.
std::jthread keep_calibrated(HdDevice& device) {
    return std::jthread([&device](const std::stop_token& stop) {
        while (!stop.stop_requested()) {
            if (needs_update(&device)) device.calibrate();
            std::this_thread::sleep_for(between_updates);
        }
    });
}

}  // namespace

// What ends first stands last.
struct HdSession::Opened {
    explicit Opened(const HdApi& api) : errors(api) {}

    HdErrorSorter errors;
    std::vector<std::unique_ptr<HdDevice>> owned;
    std::vector<Device*> devices;
    std::optional<HdServo> servo;
    std::jthread calibrator;
};

HdSession::HdSession(const HdSettings& settings) {
    const std::vector<std::string> names = names_of(settings);
    const NumbersInC numbers_in_c;
    const HdApi& api = load_hd_library(settings.library);
    auto opened = std::make_unique<Opened>(api);
    std::vector<HdDevice*> devices;
    std::vector<SetupResult> notes;
    for (const std::string& name : names) {
        opened->owned.push_back(std::make_unique<HdDevice>(api, opened->errors, name, names.size() == 1));
        devices.push_back(opened->owned.back().get());
        opened->devices.push_back(devices.back());
        if (devices.back()->opened_instead())
            notes.push_back({false, "the driver did not open a device by the name '" + name +
                                        "', so its default device is used; check the name in the driver's "
                                        "setup program"});
    }
    opened->servo.emplace(api, devices, notes);
    calibrate(*opened->servo, devices);
    if (devices.size() == 1) opened->calibrator = keep_calibrated(*devices.front());
    opened_ = std::move(opened);
}

HdSession::~HdSession() = default;

std::span<Device* const> HdSession::devices() {
    return opened_->devices;
}

Servo& HdSession::servo() {
    return *opened_->servo;
}

}  // namespace palpate::devices
