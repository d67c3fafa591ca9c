// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/readings/health.hpp"

#include "formats/records/fault.hpp"
#include "formats/records/tick_result.hpp"
#include "runtime/texts/translated.hpp"

namespace palpate::visual {
namespace {

// Flags of forces that are cut on purpose.
constexpr std::uint32_t ordinary = force_limited | rate_limited | coming_back;

}  // namespace

Health health_of(const VisualFrame& frame) {
    if ((frame.faults & ~std::uint32_t{servo_stopping}) != 0) return Health::no_force;
    return frame.statuses != 0 ? Health::limited : Health::good;
}

std::string health_text(const VisualFrame& frame) {
    using texts::translated;
    switch (health_of(frame)) {
        case Health::good:
            return translated("{}: force as computed", frame.device);
        case Health::limited:
            if ((frame.statuses & ~ordinary) != 0) return translated("{}: force uncertain", frame.device);
            if ((frame.statuses & coming_back) != 0) return translated("{}: force comes back", frame.device);
            return translated("{}: force limited", frame.device);
        case Health::no_force:
            break;
    }
    return translated("{}: no force", frame.device);
}

Rgb health_colour(Health health) {
    switch (health) {
        case Health::good:
            return {86, 180, 233};  // sky blue
        case Health::limited:
            return {220, 140, 0};  // orange, a little darker than theirs
        case Health::no_force:
            break;
    }
    return {213, 94, 0};  // vermilion
}

}  // namespace palpate::visual
