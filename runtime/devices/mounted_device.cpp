// SPDX-License-Identifier: Apache-2.0
#include "runtime/devices/mounted_device.hpp"

#include <cassert>
#include <cmath>

#include "formats/model/arrays.hpp"

namespace palpate::devices {
namespace {

using namespace realtime;
using Eigen::Vector3d;

constexpr double rigid_tolerance = 1e-9;  // of products of rotations in double

Device& there(const std::unique_ptr<Device>& device) {
    assert(device != nullptr);
    return *device;
}

}  // namespace

MountedDevice::MountedDevice(Device& device, const Eigen::Isometry3d& X_PD)
    : device_(device), X_PD_(X_PD), R_PD_(X_PD.linear()) {
    assert(X_PD.linear().isUnitary(rigid_tolerance) && X_PD.linear().determinant() > 0);
}

MountedDevice::MountedDevice(std::unique_ptr<Device> device, const Eigen::Isometry3d& X_PD)
    : MountedDevice(there(device), X_PD) {
    owned_ = std::move(device);
}

DeviceLimits MountedDevice::limits() const {
    DeviceLimits limits = device_.limits();
    const Vector3d low = vector_of(limits.workspace_low), high = vector_of(limits.workspace_high);
    const Vector3d middle = X_PD_ * (0.5 * (low + high));
    const Vector3d half = X_PD_.linear().cwiseAbs() * (0.5 * (high - low));
    limits.workspace_low = array_of(middle - half);
    limits.workspace_high = array_of(middle + half);
    return limits;
}

DeviceState MountedDevice::read(double time) noexcept {
    DeviceState state = device_.read(time);
    state.position = array_of(X_PD_ * vector_of(state.position));
    state.shaft = array_of(X_PD_.linear() * vector_of(state.shaft));
    state.orientation = array_of(R_PD_ * quaternion_of(state.orientation));
    return state;
}

void MountedDevice::write(const Wrench& wrench) noexcept {
    const Eigen::Matrix3d R_DP = X_PD_.linear().transpose();
    device_.write({array_of(R_DP * vector_of(wrench.force)), array_of(R_DP * vector_of(wrench.torque))});
}

Eigen::Isometry3d mount(const Eigen::Matrix3d& R_PD, const Vector3d& p_D, const Vector3d& p_P) {
    Eigen::Isometry3d X_PD = Eigen::Isometry3d::Identity();
    X_PD.linear() = R_PD;
    X_PD.translation() = p_P - R_PD * p_D;
    return X_PD;
}

Eigen::Matrix3d upright(const Vector3d& up) {
    Vector3d x = Vector3d::UnitX() - up.x() * up;
    if (x.squaredNorm() < 1e-6) x = Vector3d::UnitY() - up.y() * up;  // up is along x
    x.normalize();
    Eigen::Matrix3d R_PD;
    R_PD << x, up, x.cross(up);
    return R_PD;
}

Eigen::Isometry3d mount_upright(const Vector3d& p_D, const Vector3d& p_P, const Vector3d& up) {
    return mount(upright(up), p_D, p_P);
}

Vector3d workspace_middle(const DeviceLimits& limits) {
    return 0.5 * (vector_of(limits.workspace_low) + vector_of(limits.workspace_high));
}

}  // namespace palpate::devices
