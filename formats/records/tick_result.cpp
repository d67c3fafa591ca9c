// SPDX-License-Identifier: Apache-2.0
#include "formats/records/tick_result.hpp"

#include "formats/records/shown_text.hpp"

namespace palpate {

std::span<const StatusText, status_count> status_texts() {
    static constexpr std::array<StatusText, status_count> texts{{
        {force_limited, "force_limited", shown_text("the force was cut to the largest one"), false},
        {rate_limited, "rate_limited", shown_text("the force was kept from changing faster than it may"),
         false},
        {contacts_cut, "contacts_cut",
         shown_text("more points touch than a tick solves: those that matter least are left out"), true},
        {contact_unsolved, "contact_unsolved",
         shown_text("contacts contradict each other, as in a wedge: no body gives way"), true},
        {starts_inside, "starts_inside",
         shown_text("a tool is in a body, which is not felt until the tool has been clear of it"), true},
        {coming_back, "coming_back", shown_text("the force returns by and by after a fault"), false},
        {energy_injected, "energy_injected",
         shown_text("contact gave a hand more energy than it got: a damper takes it back"), true},
        {contact_unsettled, "contact_unsettled",
         shown_text("tissue or tool was not at rest when the tick ended, as where one snaps over an edge"),
         true},
        {large_unsettled, "large_unsettled",
         shown_text("the answer of tissue that is deformed far came late, or was not settled: its force is "
                    "nearer to that of linear tissue"),
         true},
    }};
    return texts;
}

std::string status_text(std::uint32_t status) {
    std::string text;
    for (const StatusText& known : status_texts()) {
        if (!(status & known.status)) continue;
        if (!text.empty()) text += '+';
        text += known.name;
    }
    return status == tick_ok ? "ok" : text;
}

}  // namespace palpate
