// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/stages/mesh_result.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/model/errors.hpp"
#include "formats/model/regions.hpp"
#include "tools/meshing/contract/contract_json.hpp"

namespace palpate::stages {

using namespace meshing;

Json to_json(const TetMesh& mesh, const MeshQuality& quality) {
    Json worst = Json::array();
    for (const WorstTetrahedron& tet : quality.worst)
        worst.push_back({{"tetrahedron", tet.tetrahedron},
                         {"min_dihedral_deg", tet.min_dihedral_deg},
                         {"max_dihedral_deg", tet.max_dihedral_deg},
                         {"at", {tet.centroid.x(), tet.centroid.y(), tet.centroid.z()}}});
    return {
        {"nodes", mesh.rest_positions.size()},
        {"tetrahedra", mesh.tetrahedra.size()},
        {"surface_nodes", std::ranges::count_if(mesh.outside_labels, [](int label) { return label >= 0; })},
        {"components", quality.components},
        {"boundary_non_manifold_edges", quality.boundary.non_manifold_edges},
        {"inverted", quality.inverted},
        {"min_dihedral_deg", quality.min_dihedral_deg},
        {"max_dihedral_deg", quality.max_dihedral_deg},
        {"dihedral_percentiles_1_5_50_95_99_deg", quality.dihedral_percentiles_deg},
        {"dihedral_histogram_10_deg", quality.dihedral_histogram},
        {"min_radius_ratio", quality.min_radius_ratio},
        {"mean_radius_ratio", quality.mean_radius_ratio},
        {"worst", worst}};
}

Json to_json(const TetMesh& mesh, const MeshMeasures& measures) {
    Json regions = Json::array();
    for (std::size_t k = 0; k < measures.fidelity.regions.size(); ++k) {
        const RegionFidelity& fidelity = measures.fidelity.regions[k];
        const RegionDistance& distance = measures.distances[k];
        regions.push_back(
            {{"name", region_name(mesh, fidelity.region)},
             {"value", fidelity.region},
             {"volume_mm3", fidelity.label_volume * (1 + fidelity.volume_error_percent / 100)},
             {"volume_error_percent", fidelity.volume_error_percent},
             {"dice", fidelity.dice},
             {"centroid_distance_mm", fidelity.centroid_distance},
             {"surface_distance_mm",
              {{"mean", distance.mean},
               {"p95", distance.percentile_95},
               {"max", distance.maximum},
               {"farthest", {distance.farthest.x(), distance.farthest.y(), distance.farthest.z()}}}}});
    }
    Json result = to_json(mesh, measures.quality);
    result["dice"] = measures.fidelity.body.dice;
    result["centroid_distance_mm"] = measures.fidelity.body.centroid_distance;
    result["regions"] = std::move(regions);
    return result;
}

Json to_json(std::span<const ContractCheck> checks) {
    Json list = Json::array();
    for (const ContractCheck& check : checks) list.push_back(meshing::to_json(check));
    return list;
}

Json to_json(const std::vector<MeshAttempt>& attempts) {
    Json list = Json::array();
    for (const MeshAttempt& attempt : attempts)
        list.push_back({{"tetrahedra", attempt.tetrahedra}, {"misses", to_json(attempt.misses)}});
    return list;
}

std::optional<ErrorDetail> shortfall_of(std::span<const ContractCheck> checks, const std::string& culprit,
                                        const std::string& next_step) {
    std::string found;
    for (const ContractCheck& check : misses(checks))
        found += fmt::format("{}{} is {} (expected {})", found.empty() ? "" : "; ", what_text(check),
                             value_text(check), limit_text(check));
    if (found.empty()) return std::nullopt;
    return ErrorDetail{culprit, found, "", next_step};
}

}  // namespace palpate::stages
