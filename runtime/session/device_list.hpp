// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <string_view>

#include "runtime/devices/device_kind.hpp"

namespace palpate::session {

/// All devices there are. A new one is files of its own and a line in device_list.cpp; a new simulated model
/// is one in devices/device_model.cpp.
std::span<const devices::DeviceKind> device_kinds();

/// A device as a user names it.
struct DeviceChoice {
    devices::DeviceKind kind;
    std::string text;     ///< the whole: "openhaptics:Left,Right"
    std::string address;  ///< what stands after the kind's name and a colon
    std::size_t tool_count = 1;

    devices::OpenDevices open(const devices::DeviceRequest& request) const {
        return kind.open(address, request);
    }
};

/// Reads "NAME" or "NAME:ADDRESS"; empty: the kind without a name. Throws UsageError of `culprit` for a name
/// that is not in the list or an address that makes no sense.
DeviceChoice choose_device(std::string_view text, const std::string& culprit = "device");

/// "touch, desktop or igtl:HOST:PORT[/NAME]": how the devices are named for which `wanted` holds.
std::string device_usages(const std::function<bool(const devices::DeviceKind&)>& wanted, bool several);

/// "touch: a simulated PHANTOM Omni in a hand that gives way; ...": the whole list in words.
std::string device_sentences();

}  // namespace palpate::session
