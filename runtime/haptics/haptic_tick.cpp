// SPDX-License-Identifier: Apache-2.0
// One tick of a haptic model: nothing here allocates, locks, waits or throws.
#include <cassert>

#include "formats/model/arrays.hpp"
#include "runtime/haptics/haptic_model.hpp"

namespace palpate::haptics {
namespace {

using Eigen::Vector3d;

constexpr double farthest_return = 5;   // mm: found again farther off than this, a tool starts anew
constexpr double farthest_turn = 0.35;  // rad: or turned by more

}  // namespace

void HapticModel::detect() noexcept {
    contact_->detect();
}

void HapticModel::detect_at(const std::array<double, 3>& device, std::int64_t tick) noexcept {
    contact_->detect_at(device, tick);
}

void HapticModel::tick(std::span<const realtime::DeviceState> devices, std::span<TickResult> results,
                       std::uint32_t faults) noexcept {
    assert(devices.size() == tools_.size() && results.size() == tools_.size());
    for (std::size_t t = 0; t < tools_.size(); ++t) {
        results[t].tool = static_cast<std::int32_t>(t);
        results[t].faults = faults | devices[t].faults;
        poses_[t] = begin(tools_[t], devices[t], results[t]);
        forces_[t].setZero();
    }
    ++tick_;
    contact_->tick(poses_, coupling_, results, forces_);
    if (method_.can.keeps_energy) observer_.damp(poses_, coupling_, results, forces_);
    for (std::size_t t = 0; t < tools_.size(); ++t) {
        TickResult& result = results[t];
        if (turns_ && !vector_of(result.torque).allFinite()) result.faults |= invalid_force;
        result.force = array_of(tools_[t].limiter.limit(forces_[t], result.faults, result.status));
        if (!turns_) continue;
        result.torque =
            array_of(tools_[t].torque_limiter.limit(vector_of(result.torque), result.faults, result.status));
    }
    if (method_.can.keeps_energy) observer_.hold(results);
}

ContactPose HapticModel::begin(Tool& tool, const realtime::DeviceState& device, TickResult& result) noexcept {
    result.tick = tick_;
    result.time = device.time;
    result.device_position = result.tool_position = device.position;
    result.shaft = device.shaft;
    result.orientation = device.orientation;
    result.tool_orientation = {0, 0, 0, 0};
    result.torque = {0, 0, 0};
    result.buttons = device.buttons;
    result.detected_tick = -1;
    result.depth = 0;
    result.residual = 0;
    result.body = -1;
    result.contact_count = 0;
    result.status = tick_ok;
    ContactPose pose{.tip = vector_of(device.position),
                     .shaft = vector_of(device.shaft),
                     .orientation = quaternion_of(device.orientation)};
    if (!pose.tip.allFinite() || !pose.shaft.allFinite() || !pose.orientation.coeffs().allFinite())
        result.faults |= invalid_position;
    if (result.faults & distrusted_position) {
        tool.lost = true;
        return pose;
    }
    pose.trusted = true;
    // The way there was not seen, so it says nothing about what lies between.
    const bool unseen = tool.lost || (result.faults & tick_late);
    pose.jumped = unseen && ((pose.tip - tool.last.tip).norm() > farthest_return ||
                             orientation_of(pose).angularDistance(orientation_of(tool.last)) > farthest_turn);
    tool.lost = false;
    tool.last = pose;
    return pose;
}

void HapticModel::surface_displacement(std::size_t body, const TickResult& result,
                                       std::span<Eigen::Vector3f> displacements) const noexcept {
    bodies_.deformable[body - rigid_count()].surface_displacement(result.active_contacts(), displacements);
}

}  // namespace palpate::haptics
