// SPDX-License-Identifier: Apache-2.0
#include "runtime/session/device_list.hpp"

#include <algorithm>
#include <vector>

#include "formats/model/errors.hpp"
#include "runtime/devices/openhaptics/hd_kind.hpp"
#include "runtime/devices/simulation.hpp"
#include "runtime/openigtlink/tracker_kind.hpp"

namespace palpate::session {
namespace {

using namespace devices;

std::vector<DeviceKind> all_kinds() {
    std::vector<DeviceKind> kinds{stiff_hand_kind()};
    for (DeviceKind& kind : simulated_kinds()) kinds.push_back(std::move(kind));
    kinds.push_back(openhaptics_kind());
    kinds.push_back(openigtlink::tracker_kind());
    return kinds;
}

// The forms in which devices are named, "a, b or c".
std::string usages_of(std::span<const DeviceKind> kinds, const std::function<bool(const DeviceKind&)>& wanted,
                      bool several) {
    std::vector<std::string> usages;
    for (const DeviceKind& kind : kinds) {
        if (kind.name.empty() || !wanted(kind)) continue;
        usages.push_back(kind.usage);
        if (several && !kind.usage_of_several.empty()) usages.push_back(kind.usage_of_several);
    }
    std::string text;
    for (std::size_t i = 0; i < usages.size(); ++i)
        text += (i == 0 ? "" : i + 1 == usages.size() ? " or " : ", ") + usages[i];
    return text;
}

bool any_kind(const DeviceKind&) {
    return true;
}

}  // namespace

std::span<const DeviceKind> device_kinds() {
    static const std::vector<DeviceKind> kinds = all_kinds();
    return kinds;
}

DeviceChoice choose_device(std::string_view text, const std::string& culprit) {
    const std::string_view name = text.substr(0, text.find(':'));
    const auto kind = std::ranges::find(device_kinds(), name, &DeviceKind::name);
    const bool known = kind != device_kinds().end();
    const std::string_view address = text.size() > name.size() ? text.substr(name.size() + 1) : "";
    const bool bare_colon = text.size() == name.size() + 1;
    const auto tools = known && !bare_colon ? kind->tool_count(address) : std::nullopt;
    if (tools) return {*kind, std::string(text), std::string(address), *tools};
    const bool takes_address = known && kind->usage != kind->name;
    throw UsageError({culprit, std::string(text),
                      takes_address ? usages_of({&*kind, 1}, any_kind, true) : device_usages(any_kind, true),
                      ""});
}

std::string device_usages(const std::function<bool(const DeviceKind&)>& wanted, bool several) {
    return usages_of(device_kinds(), wanted, several);
}

std::string device_sentences() {
    std::string text;
    for (const DeviceKind& kind : device_kinds())
        if (!kind.name.empty())
            text += (text.empty() ? "" : "; ") + usages_of({&kind, 1}, any_kind, true) + ": " + kind.sentence;
    return text;
}

}  // namespace palpate::session
