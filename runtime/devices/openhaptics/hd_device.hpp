// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <atomic>
#include <cstdint>
#include <string>

#include "runtime/devices/openhaptics/hd_api.hpp"
#include "runtime/devices/openhaptics/hd_error.hpp"
#include "runtime/devices/openhaptics/speed_watch.hpp"
#include "runtime/realtime/device.hpp"

namespace palpate::devices {

/// A device of an HDAPI library, open from construction to destruction, its force output enabled. Frame D as
/// HDAPI has it: +x right, +y up, +z towards the user, mm. read() begins a frame and write() ends it, so that
/// several devices' frames of one tick overlap, as in the example for two devices that OpenHaptics has. Both
/// are for the scheduler's thread; everything else for one other thread.
///
/// A device that states six degrees of freedom of its output gets torque besides, where its driver takes it
/// in frame D; limits().max_torque tells.
///
/// Faults: motors_warm from the moment a motor's temperature is 1 until all are below motors_cool;
/// pose_frozen while the pose is the one of encoders without data; implausible_speed while the position is
/// farther from the last plausible one than a hand gets in that time, see SpeedWatch; not_calibrated while
/// somebody has to move the stylus for it, and where an update has not helped; the errors of the driver as
/// hd_error_texts() has them, for as long as they come.
class HdDevice final : public realtime::Device {
  public:
    static constexpr int look_ticks = 100;    ///< between two looks at temperature and calibration
    static constexpr int frozen_ticks = 100;  ///< that a pose without data must last to be a fault
    static constexpr double motors_cool = 0.9;

    /// Opens the device that the driver's setup calls `name`; empty: the default device, by the names that
    /// different drivers have for it. A driver that knows no device by `name` is asked for its default one
    /// where `or_default`; opened_instead() tells then. The scheduler must not run yet. Throws SystemFailure
    /// with cause and fix. `api` and `errors` must outlive this.
    HdDevice(const HdApi& api, HdErrorSorter& errors, const std::string& name, bool or_default);
    HdDevice(const HdDevice&) = delete;
    HdDevice& operator=(const HdDevice&) = delete;
    ~HdDevice() override;  ///< switches the force output off and closes the device

    /// "Touch 1234 'Left'": model, serial number and name, as far as there are any.
    std::string name() const override { return label_; }
    /// As the driver tells; its own damping is not known.
    DeviceLimits limits() const override { return limits_; }
    /// As of the last look: in the first tick and then every look_ticks.
    realtime::Calibration calibration() override { return calibration_.load(); }
    /// Brings an automatic or inkwell calibration up to date; the next tick looks again. Other styles need
    /// somebody's hand: nothing happens. Not beside ticks of several devices.
    void calibrate() override;
    /// What somebody has to do with the stylus to calibrate this device.
    std::string how_to_calibrate() const;
    /// True where the default device was opened because the name was not found.
    bool opened_instead() const { return opened_instead_; }

    /// Asks the driver anew for the rate of its servo, which it knows once the scheduler runs; not while it
    /// ticks.
    void ask_rate();

    realtime::DeviceState read(double time) noexcept override;
    void write(const realtime::Wrench& wrench) noexcept override;

  private:
    HdErrorInfo open_one_of(const std::string& name, bool or_default);
    HdErrorInfo open(const char* name);
    void describe(const std::string& name);
    double nominal(unsigned parameter) const;
    void describe_torque();
    void look() noexcept;
    realtime::Calibration ask_calibration() noexcept;
    bool frozen(const std::array<double, 3>& position) noexcept;

    const HdApi& api_;
    HdErrorSorter& errors_;
    HdHandle handle_ = hdapi::invalid_handle;
    std::string label_;
    DeviceLimits limits_;
    bool renders_torque_ = false;
    unsigned calibration_styles_ = 0;
    bool opened_instead_ = false;
    std::atomic<realtime::Calibration> calibration_{realtime::Calibration::ok};
    std::atomic<bool> look_now_{true};
    bool in_frame_ = false;  // the scheduler's thread's, as are the next
    bool warm_ = false, misplaced_ = false;
    int ticks_to_look_ = 0;
    int ticks_frozen_ = 0;
    SpeedWatch speed_;
    std::array<double, 3> position_{0, 0, 0}, shaft_{0, 0, 0};  // the last good pose
    std::array<double, 4> orientation_{0, 0, 0, 0};
    bool placed_ = false;  // there has been one
};

}  // namespace palpate::devices
