// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <functional>
#include <gtest/gtest.h>
#include <memory>
#include <ostream>
#include <span>
#include <string>
#include <vector>

#include "formats/records/fault.hpp"
#include "runtime/devices/hand_path.hpp"
#include "runtime/realtime/device.hpp"
#include "runtime/realtime/servo.hpp"

/// What every device must do, whatever stands behind it. A backend registers itself in a file of its own by
/// INSTANTIATE_TEST_SUITE_P of those suites below that it can play; the facts are in device_conformance.cpp.
namespace palpate::conformance {

/// From `from` to `until`, s of the device's time.
struct Press {
    unsigned button = 0;
    double from = 0, until = 0;
};
struct Mishap {
    std::string fault;  ///< in the backend's own words
    double from = 0, until = 0;
};

/// What a device is to live through.
struct DeviceWish {
    devices::HandPath path;  ///< of the hand, frame D
    std::vector<Press> presses{};
    std::vector<Mishap> mishaps{};
};

/// Devices that are open, and the servo they want to be read in.
class OpenDevices {
  public:
    virtual ~OpenDevices() = default;
    virtual std::span<realtime::Device* const> devices() = 0;
    virtual realtime::Servo& servo() = 0;
    /// The devices' own time in a tick of the servo, s.
    virtual double time(const realtime::ServoTick& wake) { return wake.time; }
    /// The force that stands at the hardware, N; not beside a running servo.
    virtual std::array<double, 3> force(std::size_t device) = 0;
};

struct Backend {
    std::string name;
    std::function<std::unique_ptr<OpenDevices>(const std::vector<DeviceWish>&)> open;
};
inline void PrintTo(const Backend& backend, std::ostream* out) {
    *out << backend.name;
}

/// A fault that a backend can arrange, and the flag it must appear as.
struct FaultCase {
    Backend backend;
    std::string fault;
    Fault flag = no_fault;
    double patience = 0.020;  ///< s of the device's time until it has appeared, and again until it is gone
};
inline void PrintTo(const FaultCase& fault, std::ostream* out) {
    *out << fault.backend.name << " " << fault.fault;
}

/// Of every backend.
class DeviceConformance : public testing::TestWithParam<Backend> {};
/// Of those with buttons.
class ButtonConformance : public testing::TestWithParam<Backend> {};
/// Of those whose hand gives way.
class ForceConformance : public testing::TestWithParam<Backend> {};
/// Of each fault of those that can have any.
class FaultConformance : public testing::TestWithParam<FaultCase> {};

/// Names an instance by its backend, and by its fault.
inline std::string backend_name(const testing::TestParamInfo<Backend>& info) {
    return info.param.name;
}
inline std::string fault_case_name(const testing::TestParamInfo<FaultCase>& info) {
    return info.param.backend.name + "_" + info.param.fault;
}

/// Opens devices of this process in a PeriodicServo.
std::unique_ptr<OpenDevices> with_periodic_servo(std::vector<std::unique_ptr<realtime::Device>> devices);

}  // namespace palpate::conformance
