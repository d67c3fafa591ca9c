// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "runtime/realtime/device.hpp"
#include "runtime/realtime/servo.hpp"

namespace palpate::devices {

struct HdSettings {
    std::filesystem::path library;     ///< of the driver; empty: PALPATE_HD_LIBRARY, then the known names
    std::vector<std::string> devices;  ///< names as configured; empty: the default device
};

/// Opened devices of one HDAPI library and the servo that ticks them: devices of the SensAble and 3D Systems
/// Phantom and Touch families. A single device's calibration is kept up to date by a thread of its own, for
/// that must not be done in the servo; several are brought up to date when they are opened, for HDAPI has one
/// current device, and nobody says whether each thread has its own. One at a time in a process; another may
/// be opened after it. However it ends, the forces go to zero, the scheduler stops and the devices are
/// closed, in this order; a process that is killed before may find the device blocked until it is plugged in
/// again.
class HdSession {
  public:
    /// Loads the library, opens every device, starts the scheduler and brings the calibrations up to date.
    /// Where a driver does not know the only device by its name, its default device is opened instead, and
    /// servo().setup() says so. Numbers are read in the C locale meanwhile, for drivers read their
    /// configuration by the process's: no other thread may depend on LC_NUMERIC. Takes 10 ms, and as long as
    /// the driver takes. Throws InvalidInput (library, names) or SystemFailure (driver, device, calibration)
    /// with cause and fix.
    explicit HdSession(const HdSettings& settings);
    HdSession(const HdSession&) = delete;
    HdSession& operator=(const HdSession&) = delete;
    ~HdSession();

    /// In the order of HdSettings::devices.
    std::span<realtime::Device* const> devices();
    realtime::Servo& servo();

  private:
    struct Opened;
    std::unique_ptr<Opened> opened_;
};

}  // namespace palpate::devices
