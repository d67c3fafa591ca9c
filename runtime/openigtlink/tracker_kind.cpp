// SPDX-License-Identifier: Apache-2.0
#include "runtime/openigtlink/tracker_kind.hpp"

#include "runtime/openigtlink/address.hpp"
#include "runtime/openigtlink/tracked_device.hpp"

namespace palpate::openigtlink {

using namespace devices;

DeviceKind tracker_kind() {
    return {.name = "igtl",
            .usage = "igtl:HOST:PORT[/NAME]",
            .usage_of_several = "",
            .sentence = "a tracker's tool over OpenIGTLink, without force",
            .renders_force = false,
            .tool_count = [](std::string_view address) -> std::optional<std::size_t> {
                parse_tracker_address(address);
                return 1;
            },
            .open =
                [](std::string_view address, const DeviceRequest&) {
                    OpenDevices open;
                    open.devices.push_back(std::make_shared<TrackedDevice>(parse_tracker_address(address)));
                    return open;
                }};
}

}  // namespace palpate::openigtlink
