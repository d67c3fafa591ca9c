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

// A model with mass, in a hand that gives way.
Backend dynamic(const std::string& name, const std::string& model) {
    return {name, [model](const std::vector<DeviceWish>& wishes) {
                std::vector<std::unique_ptr<realtime::Device>> devices;
                for (const DeviceWish& wish : wishes)
                    devices.push_back(std::make_unique<DynamicDevice>(find_device_model(model),
                                                                      HandImpedance{}, wish.path));
                return with_periodic_servo(std::move(devices));
            }};
}

const Backend simulated{"simulated", open_simulated},
    touch = dynamic("touch", "touch"), desktop = dynamic("desktop", "desktop"),
    premium = dynamic("premium", "premium"), premium_6dof = dynamic("premium_6dof", "premium-6dof");

INSTANTIATE_TEST_SUITE_P(InProcess, DeviceConformance,
                         testing::Values(simulated, touch, desktop, premium, premium_6dof), backend_name);
INSTANTIATE_TEST_SUITE_P(InProcess, ForceConformance, testing::Values(touch, desktop, premium, premium_6dof),
                         backend_name);

}  // namespace
}  // namespace palpate::conformance
