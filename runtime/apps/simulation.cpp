// SPDX-License-Identifier: Apache-2.0
#include "runtime/apps/simulation.hpp"

#include <utility>

#include "runtime/devices/dynamic_device.hpp"
#include "runtime/devices/mounted_device.hpp"

namespace palpate {

using Eigen::Vector3d;

Eigen::Isometry3d placed_at(const DeviceModel& model, const Vector3d& start, const Vector3d& up) {
    return mount_upright(workspace_middle(limits_of(model)), start, up);
}

std::unique_ptr<Device> simulate(const DeviceModel& model, std::shared_ptr<Hand> hand,
                                 const Eigen::Isometry3d& X_PD, const std::array<double, 3>& shaft) {
    const Vector3d s = X_PD.linear().transpose() * Eigen::Map<const Vector3d>(shaft.data());
    auto device = std::make_unique<DynamicDevice>(model, HandImpedance{}, std::move(hand),
                                                  std::array<double, 3>{s[0], s[1], s[2]});
    return std::make_unique<MountedDevice>(std::move(device), X_PD);
}

std::unique_ptr<Device> simulate(const DeviceModel& model, const HandPath& path, const Vector3d& up,
                                 const std::array<double, 3>& shaft) {
    const Eigen::Isometry3d X_PD = placed_at(model, path.at(0), up);
    return simulate(model, std::make_shared<ScriptedHand>(mapped_path(path, X_PD.inverse())), X_PD, shaft);
}

}  // namespace palpate
