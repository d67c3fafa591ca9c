// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <memory>
#include <string>

#include "runtime/realtime/device.hpp"

namespace palpate::devices {

/// A device at its place in the patient: maps positions, directions and orientations from its frame D to P,
/// and forces and torques back. Lengths, forces and torques keep their size.
class MountedDevice final : public realtime::Device {
  public:
    /// `device` must outlive this. `X_PD`: a rigid motion (asserted), mm.
    MountedDevice(realtime::Device& device, const Eigen::Isometry3d& X_PD);
    /// The same, owning the device, which must not be null (asserted).
    MountedDevice(std::unique_ptr<realtime::Device> device, const Eigen::Isometry3d& X_PD);

    std::string name() const override { return device_.name(); }
    /// The device's own, its workspace as the box in P around its corners.
    DeviceLimits limits() const override;
    realtime::Calibration calibration() override { return device_.calibration(); }
    void calibrate() override { device_.calibrate(); }
    realtime::DeviceState read(double time) noexcept override;
    void write(const realtime::Wrench& wrench) noexcept override;

  private:
    std::unique_ptr<realtime::Device> owned_;  // null: another's
    realtime::Device& device_;
    Eigen::Isometry3d X_PD_;
    Eigen::Quaterniond R_PD_;
};

/// Where a device is mounted that is turned by R_PD, and whose point `p_D` is at `p_P` (both mm).
Eigen::Isometry3d mount(const Eigen::Matrix3d& R_PD, const Eigen::Vector3d& p_D, const Eigen::Vector3d& p_P);

/// Which way is up for a device whose tool is to touch no surface known beforehand: towards the patient's
/// front, -y of LPS.
inline const Eigen::Vector3d anterior{0, -1, 0};

/// How a device is turned, R_PD, so that its y axis (up, on a Phantom) is along `up` (unit); its x axis is as
/// near to the patient's x, from right to left, as that allows.
Eigen::Matrix3d upright(const Eigen::Vector3d& up);

/// Both together.
Eigen::Isometry3d mount_upright(const Eigen::Vector3d& p_D, const Eigen::Vector3d& p_P,
                                const Eigen::Vector3d& up);

/// The middle of a device's workspace, p_D, mm; the origin where the workspace is not known.
Eigen::Vector3d workspace_middle(const DeviceLimits& limits);

}  // namespace palpate::devices
