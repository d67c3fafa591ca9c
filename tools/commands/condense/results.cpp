// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/commands/condense/results.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tools/cli/record_json.hpp"

namespace palpate::condensation {

using Json = nlohmann::ordered_json;

Json to_json(const Certificate& certificate) {
    return cli::record_json(certificate_fields, certificate);
}

Json to_json(const CondensationPlan& plan) {
    Json forecasts = Json::array();
    for (const CondensationForecast& forecast : plan.considered)
        forecasts.push_back({{"method", name_of(forecast.method)},
                             {"seconds", forecast.seconds},
                             {"memory_bytes", forecast.memory_bytes},
                             {"size_bytes", forecast.size_bytes}});
    return {{"method", name_of(plan.chosen.method)}, {"reason", plan.reason}, {"forecasts", forecasts}};
}

std::string representation_of(const SurfaceCompliance& compliance) {
    const auto* blocks = std::get_if<HierarchicalCompliance>(&compliance);
    return blocks ? fmt::format("hierarchical to {:g}", blocks->accuracy) : "dense";
}

}  // namespace palpate::condensation
