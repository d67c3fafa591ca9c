// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include "runtime/devices/dynamics/dynamic_device.hpp"
#include "runtime/devices/simulated_device.hpp"
#include "tests/runtime/devices/conformance/device_conformance.hpp"

namespace palpate::conformance {
namespace {

using namespace devices;

std::unique_ptr<OpenDevices> open_simulated(const std::vector<DeviceWish>& wishes) {
    std::vector<std::unique_ptr<realtime::Device>> devices;
    for (const DeviceWish& wish : wishes)
        devices.push_back(std::make_unique<SimulatedDevice>(
            wish.path, DeviceLimits{.max_force = 3.3, .max_stiffness = 0.5}));
    return with_periodic_servo(std::move(devices));
}

std::unique_ptr<OpenDevices> open_dynamic(const std::vector<DeviceWish>& wishes) {
    std::vector<std::unique_ptr<realtime::Device>> devices;
    for (const DeviceWish& wish : wishes)
        devices.push_back(
            std::make_unique<DynamicDevice>(find_device_model("touch"), HandImpedance{}, wish.path));
    return with_periodic_servo(std::move(devices));
}

const Backend simulated{"simulated", open_simulated}, dynamic{"dynamic", open_dynamic};

INSTANTIATE_TEST_SUITE_P(InProcess, DeviceConformance, testing::Values(simulated, dynamic), backend_name);
INSTANTIATE_TEST_SUITE_P(InProcess, ForceConformance, testing::Values(dynamic), backend_name);

}  // namespace
}  // namespace palpate::conformance
