// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "runtime/devices/device_kind.hpp"

namespace palpate::openigtlink {

/// A tracker's tool, by the address of parse_tracker_address(); it tells of the patient's frame itself.
/// Opening throws as TrackedDevice.
devices::DeviceKind tracker_kind();

}  // namespace palpate::openigtlink
