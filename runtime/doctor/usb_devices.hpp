// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "runtime/doctor/machine.hpp"

namespace palpate::doctor {

/// A Phantom on a USB port.
struct UsbDevice {
    std::string id;        ///< "2988:0302"
    std::string node;      ///< "/dev/ttyACM0" or "/dev/hidraw1"; empty if the kernel made none
    bool may_use = false;  ///< this process may read and write the node
};

/// Finds the Phantoms among the machine's USB devices: those of vendor 2988, and of the first Touch with USB
/// 0301:2988, which has the two swapped (jhu-saw/sawSensablePhantom, README). In the order of their ports.
std::vector<UsbDevice> find_usb_devices(const Machine& machine);

}  // namespace palpate::doctor
