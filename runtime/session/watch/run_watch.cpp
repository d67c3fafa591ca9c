// SPDX-License-Identifier: Apache-2.0
#include "runtime/session/watch/run_watch.hpp"

#include <nlohmann/json.hpp>
#include <utility>

namespace palpate::session {

RunWatch::RunWatch(const std::filesystem::path& asset, haptics::ServoLoop& loop,
                   std::function<void(const std::string&)> tell)
    : log_([tell = std::move(tell)](const FaultEvent& event) { tell(fault_sentence(event)); }) {
    if (!asset.empty()) asset_.emplace(asset, [&loop](bool gone) { loop.set_fault(asset_removed, gone); });
}

std::uint32_t RunWatch::recent(double time) const {
    std::uint32_t faults = no_fault;
    for (const FaultEvent& event : log_.events())
        if (time - event.until < reading_time) faults |= event.fault;
    return faults;
}

nlohmann::ordered_json RunWatch::faults_json() const {
    auto faults = nlohmann::ordered_json::array();
    for (const FaultEvent& event : log_.events()) {
        nlohmann::ordered_json fault{{"fault", fault_names(event.fault)}, {"tool", nullptr}};
        if (event.tool >= 0) fault["tool"] = event.tool;
        fault["from_s"] = event.from;
        fault["until_s"] = event.until;
        faults.push_back(std::move(fault));
    }
    return faults;
}

}  // namespace palpate::session
