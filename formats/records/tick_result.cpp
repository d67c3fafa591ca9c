// SPDX-License-Identifier: Apache-2.0
#include "formats/records/tick_result.hpp"

#include <utility>

namespace palpate {

std::string status_text(std::uint32_t status) {
    constexpr std::array<std::pair<std::uint32_t, const char*>, 6> names{
        {{force_limited, "force_limited"},
         {rate_limited, "rate_limited"},
         {contacts_cut, "contacts_cut"},
         {contact_unsolved, "contact_unsolved"},
         {starts_inside, "starts_inside"},
         {coming_back, "coming_back"}}};
    std::string text;
    for (const auto& [flag, name] : names) {
        if (!(status & flag)) continue;
        if (!text.empty()) text += '+';
        text += name;
    }
    return status == tick_ok ? "ok" : text;
}

}  // namespace palpate
