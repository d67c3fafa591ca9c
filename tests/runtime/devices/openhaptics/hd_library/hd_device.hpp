// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>

#include "runtime/realtime/device.hpp"
#include "tests/runtime/devices/openhaptics/hd_library/hd_script.hpp"
#include "tests/runtime/devices/openhaptics/hd_library/hd_types.hpp"

namespace palpate::hd {

/// A device's state as of one frame, frame D.
struct Snapshot {
    Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< mm
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< mm/s, smoothed
    std::array<double, 3> joint_angles{0, 0, 0};         ///< rad
    std::uint32_t buttons = 0;
    Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();  ///< of the stylus, its third column the shaft
};

/// One device behind the C interface: a simulated one, its frames, its safety and its troubles. A function
/// that can fail returns the code of its error. Not safe beside itself; allocates only when made.
class HdDevice {
  public:
    HdDevice(const DeviceScript& script, double period);

    const DeviceScript& script() const noexcept { return script_; }

    /// A tick begins at `time` (s, device's own): the hardware goes there. Returns an error of the timer.
    Code begin_tick(double time) noexcept;
    /// A tick ends. A frame left open is closed without its force: frame_error.
    Code end_tick() noexcept;
    /// When a standstill of the scheduler that has begun ends; no later than `time` where there is none.
    double stalled_until(double time) const noexcept;

    /// `in_tick`: within a tick of the scheduler, where a second frame may be refused.
    Code begin_frame(bool in_tick) noexcept;
    Code end_frame() noexcept;
    bool in_frame() const noexcept { return frames_open_ > 0; }

    const Snapshot& current() const noexcept { return current_; }
    const Snapshot& last() const noexcept { return last_; }
    bool in_inkwell() const noexcept { return script_.in_inkwell; }
    double temperature() const noexcept { return has(Trouble::warm_motors) ? 1.0 : 0.2; }

    bool& capability(unsigned which) noexcept { return capabilities_[which - force_output]; }
    void enable(unsigned which, bool on) noexcept;
    Code set_force(const Eigen::Vector3d& force) noexcept;
    const Eigen::Vector3d& force() const noexcept { return wanted_; }
    /// Of a device with motors in its gimbal, N mm, frame D.
    Code set_torque(const Eigen::Vector3d& torque) noexcept;
    const Eigen::Vector3d& torque() const noexcept { return wanted_torque_; }
    bool has_gimbal_motors() const noexcept { return script_.model.max_torque > 0; }

    CalibrationState check_calibration() const noexcept;
    Code update_calibration(unsigned style) noexcept;

    /// Takes the force away, as when the servo ends; ramps up from zero when it comes back.
    void power_down() noexcept;
    Hardware hardware() const noexcept;

    double velocity_limit = 1000;  ///< mm/s
    double impulse_limit;          ///< N, between two frames
    double ramping_rate = 10;      ///< N/s

  private:
    bool has(Trouble trouble) const noexcept;
    Code refusal_of(const Eigen::Vector3d& force) const noexcept;
    void render(const Eigen::Vector3d& force, const Eigen::Vector3d& torque) noexcept;

    DeviceScript script_;
    double period_, time_ = 0;
    std::unique_ptr<realtime::Device> device_;
    Snapshot reading_, current_, last_;  // of this tick, of this frame, of the frame before
    Eigen::Vector3d tip_, velocity_ = Eigen::Vector3d::Zero(), wanted_ = Eigen::Vector3d::Zero(),
                          asked_ = Eigen::Vector3d::Zero(), rendered_ = Eigen::Vector3d::Zero(),
                          wanted_torque_ = Eigen::Vector3d::Zero(), torque_ = Eigen::Vector3d::Zero();
    std::array<bool, 5> capabilities_{false, true, true, true, true};
    CalibrationState calibration_;
    double ramp_ = 0;  // N, the most that ramping allows now
    int frames_open_ = 0;
    bool frame_done_ = false;  // in this tick
};

}  // namespace palpate::hd
