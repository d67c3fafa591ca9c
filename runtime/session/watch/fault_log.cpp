// SPDX-License-Identifier: Apache-2.0
#include "runtime/session/watch/fault_log.hpp"

#include <algorithm>
#include <fmt/format.h>

#include "runtime/haptics/force_limiter.hpp"

namespace palpate::session {
namespace {

constexpr std::uint32_t of_one_device = distrusted_position | motors_warm | device_refused | invalid_force;
constexpr double return_s = 1e-3 * (haptics::ForceLimiter::ramp_ticks + haptics::ForceLimiter::return_ticks);

}  // namespace

void FaultLog::add(const TickResult& result) {
    if (result.faults == no_fault) return;
    for (const FaultText& text : fault_texts()) {
        if (!(result.faults & text.fault) || text.fault == servo_stopping) continue;
        const std::int32_t tool = (text.fault & of_one_device) ? result.tool : -1;
        const auto last = std::find_if(events_.rbegin(), events_.rend(), [&](const FaultEvent& event) {
            return event.fault == text.fault && event.tool == tool;
        });
        if (last != events_.rend() && result.time - last->until < return_s) {
            last->until = result.time;
            continue;
        }
        events_.push_back({text.fault, tool, result.time, result.time});
        if (tell_) tell_(events_.back());
    }
}

std::string fault_sentence(const FaultEvent& event) {
    const auto texts = fault_texts();
    const auto text = std::ranges::find(texts, event.fault, &FaultText::fault);
    return fmt::format("{:.3f} s{}: {} ({}), so the force goes to zero; {}", event.from,
                       event.tool > 0 ? fmt::format(", tool {}", event.tool + 1) : "", text->cause,
                       text->name, text->remedy);
}

}  // namespace palpate::session
