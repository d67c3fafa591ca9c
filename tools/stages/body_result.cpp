// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/stages/body_result.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tools/cli/record_json.hpp"

namespace palpate::stages {

using namespace fem;

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
    return {{"method", name_of(plan.chosen.method)},
            {"reason", plan.reason},
            {"threads", plan.threads},
            {"forecasts", forecasts}};
}

Json to_json(const MadeBody& made) {
    const DeformableBody& body = made.body;
    Json sag;
    if (made.sag)
        sag = {{"largest_displacement_mm", made.sag->largest_displacement},
               {"largest_stretch_percent", 100 * made.sag->largest_stretch}};
    return {{"name", body.name},
            {"nodes", body.mesh.rest_positions.size()},
            {"tetrahedra", body.mesh.tetrahedra.size()},
            {"element_order", name_of(body.element_order)},
            {"surface_nodes", body.boundary.nodes.size()},
            {"fixed_nodes", body.fixed_nodes.size()},
            {"contact_nodes", body.contact_nodes.size()},
            {"representation", representation_of(body.compliance)},
            {"compliance_bytes", value_bytes(body.compliance)},
            {"sag", sag},
            {"plan", to_json(made.plan)},
            {"certificate", to_json(body.certificate)}};
}

std::string name_of(ElementOrder order) {
    return order == ElementOrder::linear ? "linear" : "quadratic";
}

std::string representation_of(const SurfaceCompliance& compliance) {
    const auto* blocks = std::get_if<HierarchicalCompliance>(&compliance);
    return blocks ? fmt::format("hierarchical to {:g}", blocks->accuracy) : "dense";
}

}  // namespace palpate::stages
