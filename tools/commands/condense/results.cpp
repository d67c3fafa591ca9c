// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/commands/condense/results.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace palpate::condensation {

using Json = nlohmann::ordered_json;

Json to_json(const Certificate& certificate) {
    return {{"residual", certificate.residual},
            {"residual_double",
             certificate.residual_double < 0 ? Json(nullptr) : Json(certificate.residual_double)},
            {"asymmetry", certificate.asymmetry},
            {"reciprocity", certificate.reciprocity},
            {"smallest_eigenvalue_mm_per_n", certificate.smallest_eigenvalue},
            {"largest_eigenvalue_mm_per_n", certificate.largest_eigenvalue},
            {"condition_number", certificate.condition_number},
            {"sampled_columns", certificate.sampled_columns},
            {"load_error", certificate.load_error},
            {"contact_error", certificate.contact_error},
            {"sampled_loads", certificate.sampled_loads},
            {"smallest_patch_eigenvalue_mm_per_n", certificate.smallest_patch_eigenvalue},
            {"discretisation_error",
             certificate.discretisation_error < 0 ? Json(nullptr) : Json(certificate.discretisation_error)},
            {"free_dofs", certificate.free_dofs}};
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
