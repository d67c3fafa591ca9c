// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/inspection/asset_summary.hpp"

#include <algorithm>

#include "formats/asset/asset.hpp"
#include "tools/cli/record_json.hpp"
#include "tools/stages/body_result.hpp"
#include "tools/stages/feel_result.hpp"
#include "tools/stages/image.hpp"

namespace palpate::inspection {
namespace {

using Json = nlohmann::ordered_json;

// Provenance is free text to the asset; what is JSON is shown as such.
Json provenance_of(const std::string& text) {
    const Json json = Json::parse(text, nullptr, false);
    return json.is_discarded() ? Json(text) : json;
}

}  // namespace

Json row_of(const RigidBody& body) {
    return {{"name", body.name},
            {"kind", "rigid"},
            {"nodes", body.surface.vertices.size()},
            {"tetrahedra", 0},
            {"triangles", body.surface.triangles.size()},
            {"surface_nodes", body.surface.vertices.size()},
            {"fixed_nodes", 0},
            {"contact_nodes", 0},
            {"compliance_mb", 0.0},
            {"obb_nodes", body.obb_tree.nodes.size()},
            {"large_deformation", false}};
}

Json row_of(const DeformableBody& body) {
    return {{"name", body.name},
            {"kind", "deformable"},
            {"nodes", body.mesh.rest_positions.size()},
            {"tetrahedra", body.mesh.tetrahedra.size()},
            {"triangles", body.boundary.surface.triangles.size()},
            {"surface_nodes", body.boundary.nodes.size()},
            {"fixed_nodes", body.fixed_nodes.size()},
            {"contact_nodes", body.contact_nodes.size()},
            {"compliance_mb", static_cast<double>(value_bytes(body.compliance)) * 1e-6},
            {"obb_nodes", body.obb_tree.nodes.size()},
            {"large_deformation", body.large_deformation}};
}

void add_regions(Json& rows, const DeformableBody& body) {
    for (std::size_t i = 0; i < body.materials.size(); ++i) {
        const auto& [region, material] = body.materials[i];
        double volume = 0;  // mm³
        for (std::size_t t = 0; t < body.mesh.tetrahedra.size(); ++t)
            if (body.mesh.regions[t] == region) volume += six_volume(body.mesh, t) / 6;
        rows.push_back({{"body", body.name},
                        {"region", body.mesh.region_names[i].name},
                        {"label", region},
                        {"youngs_modulus_kpa", material.youngs_modulus / 1e-3},  // of 9 * 1e-3, 9
                        {"poissons_ratio", material.poissons_ratio},
                        {"relaxation", relaxation_text(relaxation_of(body, region))},
                        {"tetrahedra", std::ranges::count(body.mesh.regions, region)},
                        {"volume_ml", volume * 1e-3}});
    }
}

Json certificate_row(const DeformableBody& body) {
    Json row{{"body", body.name},
             {"element_order", stages::name_of(body.element_order)},
             {"representation", stages::representation_of(body.compliance)}};
    row.update(stages::to_json(body.certificate));
    return row;
}

// What a tool meets on a body's surface, nothing where nothing gives way or is known.
Json with_stiffness(Json row, const Json& feel) {
    for (const char* figure : {"least_n_per_mm", "median_n_per_mm", "largest_n_per_mm"})
        row[figure] = feel.is_null() ? Json() : feel.at(figure);
    return row;
}

Json asset_json(const std::filesystem::path& asset) {
    const Case patient_case = asset::read_asset(asset);
    const auto signer = asset::signer_of(asset);
    Json bodies = Json::array(), regions = Json::array(), certificates = Json::array(), felt = Json::array();
    for (const RigidBody& body : patient_case.rigid_bodies)
        bodies.push_back(with_stiffness(row_of(body), nullptr));
    for (const DeformableBody& body : patient_case.deformable_bodies) {
        bodies.push_back(with_stiffness(row_of(body), stages::feel_summary(body)));
        add_regions(regions, body);
        certificates.push_back(certificate_row(body));
        for (Json& row : stages::felt_rows(body)) felt.push_back(std::move(row));
    }
    return {{"name", patient_case.name},
            {"bytes", std::filesystem::file_size(asset)},
            {"bodies", bodies},
            {"regions", regions},
            {"certificates", certificates},
            {"felt", felt},
            {"scan", stages::scan_json(patient_case.scan)},
            {"signed_by", signer ? Json(*signer) : Json()},
            {"haptics", cli::record_json(haptic_fields, patient_case.haptics)},
            {"provenance", provenance_of(patient_case.provenance)}};
}

}  // namespace palpate::inspection
