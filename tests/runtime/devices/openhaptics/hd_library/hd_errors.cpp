// SPDX-License-Identifier: Apache-2.0
#include "tests/runtime/devices/openhaptics/hd_library/hd_errors.hpp"

#include <algorithm>

namespace palpate::hd {

void ErrorStack::push(unsigned code, Handle device) noexcept {
    if (code == success) return;
    // A device's own errors carry a number of its driver's; this library's is the code, negative.
    errors_[next_] = {code, -static_cast<int>(code), device};
    next_ = (next_ + 1) % errors_.size();
    count_ = std::min(count_ + 1, errors_.size());
}

ErrorInfo ErrorStack::pop() noexcept {
    if (count_ == 0) return {success, 0, invalid_handle};
    --count_;
    next_ = (next_ + errors_.size() - 1) % errors_.size();
    return errors_[next_];
}

const char* error_text(unsigned code) noexcept {
    switch (code) {
        case success:
            return "no error";
        case invalid_enum:
            return "no such parameter or capability";
        case invalid_value:
            return "value out of range";
        case invalid_operation:
            return "not possible in this state";
        case invalid_input_type:
            return "parameter has another type";
        case bad_handle:
            return "no such device";
        case warm_motors:
            return "motors too warm";
        case exceeded_max_force:
            return "force too large";
        case exceeded_impulse:
            return "force changes too fast";
        case exceeded_velocity:
            return "tip too fast";
        case force_error:
            return "force cannot be rendered";
        case device_fault:
            return "device fault";
        case already_initiated:
            return "device open already";
        case comm_error:
            return "no communication with the device";
        case comm_config_error:
            return "communication is not configured";
        case timer_error:
            return "servo timer failed";
        case illegal_begin:
            return "frame begun twice in a tick";
        case illegal_end:
            return "frame ended but not begun";
        case frame_error:
            return "frame not complete";
        case invalid_priority:
            return "no such priority";
        case scheduler_full:
            return "too many callbacks";
        case invalid_licence:
            return "no valid licence";
        default:
            return "unknown error";
    }
}

}  // namespace palpate::hd
