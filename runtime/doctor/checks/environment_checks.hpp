// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "runtime/doctor/finding.hpp"
#include "runtime/doctor/machine.hpp"
#include "runtime/doctor/usb_devices.hpp"

namespace palpate::doctor {

/// Checks what device drivers and the trainer's window read from the user's surroundings: locale, display
/// and, for a device, the driver's folder with "Default Device.config".
Findings environment_findings(const Machine& machine, Purpose purpose);

/// Whether a device is plugged in and this user may use it.
Findings usb_findings(const Machine& machine, const std::vector<UsbDevice>& devices);

}  // namespace palpate::doctor
