// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <memory>

#include "runtime/devices/replayed_device.hpp"
#include "tests/runtime/devices/conformance/device_conformance.hpp"

namespace palpate::conformance {
namespace {

using namespace realtime;

constexpr int recorded_ticks = 4000;

// A record in which the wish has come true.
std::vector<DeviceState> record_of(const DeviceWish& wish) {
    std::vector<DeviceState> states(recorded_ticks);
    for (int tick = 0; tick < recorded_ticks; ++tick) {
        DeviceState& state = states[static_cast<std::size_t>(tick)];
        state.time = 1e-3 * tick;
        Eigen::Map<Eigen::Vector3d>(state.position.data()) = wish.path.at(state.time);
        for (const Press& press : wish.presses)
            if (state.time >= press.from && state.time < press.until) state.buttons |= 1U << press.button;
        for (const Mishap& mishap : wish.mishaps)
            for (const FaultText& text : fault_texts())
                if (mishap.fault == text.name && state.time >= mishap.from && state.time < mishap.until)
                    state.faults |= text.fault;
    }
    return states;
}

std::unique_ptr<OpenDevices> open_replayed(const std::vector<DeviceWish>& wishes) {
    std::vector<std::unique_ptr<Device>> devices;
    for (const DeviceWish& wish : wishes)
        devices.push_back(std::make_unique<devices::ReplayedDevice>(
            record_of(wish), DeviceLimits{.max_force = 3.3, .max_stiffness = 0.5}));
    return with_periodic_servo(std::move(devices));
}

const Backend replayed{"replayed", open_replayed};

INSTANTIATE_TEST_SUITE_P(Replayed, DeviceConformance, testing::Values(replayed), backend_name);
INSTANTIATE_TEST_SUITE_P(Replayed, ButtonConformance, testing::Values(replayed), backend_name);
INSTANTIATE_TEST_SUITE_P(Replayed, FaultConformance,
                         testing::Values(FaultCase{replayed, "device_lost", device_lost},
                                         FaultCase{replayed, "motors_warm", motors_warm},
                                         FaultCase{replayed, "pose_frozen", pose_frozen}),
                         fault_case_name);

}  // namespace
}  // namespace palpate::conformance
