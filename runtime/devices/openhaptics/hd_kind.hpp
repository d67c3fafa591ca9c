// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "runtime/devices/device_kind.hpp"

namespace palpate::devices {

/// Devices of an HDAPI driver, one tool each: those that the address names, "NAME" or "NAME,NAME", or the
/// default device. Each stands with the middle of its workspace at its tool's place. Opening throws as
/// HdSession.
DeviceKind openhaptics_kind();

}  // namespace palpate::devices
