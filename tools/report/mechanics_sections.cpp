// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <algorithm>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tools/report/charts.hpp"
#include "tools/report/html.hpp"
#include "tools/report/sections.hpp"

namespace palpate::report {
namespace {

using html::escaped;
using html::grouped;
using html::significant;

std::string count_of(const auto& container) {
    return grouped(static_cast<std::int64_t>(container.size()));
}

std::string body_title(const std::vector<MeasuredBody>& bodies, const DeformableBody& body) {
    return bodies.size() > 1 ? "<h3>" + escaped(body.name) + "</h3>\n" : "";
}

std::string rigid_table(const Case& patient_case) {
    std::vector<std::vector<std::string>> rows;
    for (const RigidBody& body : patient_case.rigid_bodies) {
        Eigen::AlignedBox3d box;
        for (const Eigen::Vector3d& p : body.surface.vertices) box.extend(p);
        rows.push_back({escaped(body.name), count_of(body.surface.triangles), count_of(body.surface.vertices),
                        count_of(body.obb_tree.nodes),
                        box.isEmpty() ? "–"
                                      : fmt::format("{:.0f} × {:.0f} × {:.0f}", box.sizes().x(),
                                                    box.sizes().y(), box.sizes().z())});
    }
    if (rows.empty()) return "";
    return html::table({{"Rigid body"},
                        {"Triangles", true},
                        {"Vertices", true},
                        {"OBB nodes", true},
                        {"Extent L × P × S, mm", true}},
                       rows);
}

// What a request says under `key`, escaped; empty if it says no text.
std::string word_of(const nlohmann::json& request, const char* key) {
    const auto found = request.find(key);
    return found != request.end() && found->is_string() ? escaped(found->get<std::string>()) : "";
}

// Where a body's shape is not the scan's.
std::string posture_sentences(const std::string& provenance) {
    const auto json = nlohmann::json::parse(provenance, nullptr, false);
    const nlohmann::json::json_pointer steps("/build/steps");
    if (!json.contains(steps) || !json[steps].is_array()) return "";
    std::string sentences;
    for (const auto& step : json[steps]) {
        if (!step.is_object() || !step.contains("request") || !step["request"].is_object()) continue;
        const nlohmann::json& request = step["request"];
        if (!word_of(request, "posture").empty())
            sentences += fmt::format(
                "<p><b>{}</b> was scanned {} and has the shape that gravity gives it {}; "
                "pictures of the scan show the former.</p>\n",
                word_of(request, "name"), word_of(request, "scanned"), word_of(request, "posture"));
    }
    return sentences;
}

}  // namespace

std::string mesh_section(const ReportPage& page) {
    std::vector<std::vector<std::string>> rows;
    std::string charts;
    for (const auto& [body, mesh, checks] : page.bodies) {
        std::string volumes;
        for (std::size_t i = 0; i < body.mesh.region_names.size(); ++i)
            volumes += fmt::format("<div>{} {:.2f} ml</div>", swatch(body.mesh.region_names[i]),
                                   mesh.region_volumes[i] / 1000);
        rows.push_back({escaped(body.name), count_of(body.mesh.rest_positions),
                        count_of(body.mesh.tetrahedra), count_of(body.boundary.nodes),
                        count_of(body.contact_nodes), count_of(body.fixed_nodes), volumes,
                        fmt::format("{:.1f}° – {:.1f}°", mesh.min_dihedral_deg, mesh.max_dihedral_deg),
                        fmt::format("{:.2f} / {:.2f}", mesh.min_radius_ratio, mesh.mean_radius_ratio)});
        charts += body_title(page.bodies, body) + "<div class=\"two\">\n" +
                  html::figure(histogram_svg(mesh.dihedral_deg, "dihedral angle", "°", 6),
                               "All six dihedral angles of every tetrahedron; a regular one has 70.5°.") +
                  html::figure(histogram_svg(mesh.radius_ratio, "radius ratio", "", 5),
                               "Three times the inscribed over the circumscribed radius: 1 is regular, 0 is "
                               "flat.") +
                  "</div>\n";
    }
    std::string content;
    if (!rows.empty())
        content += html::table({{"Deformable body"},
                                {"Nodes", true},
                                {"Tetrahedra", true},
                                {"Surface nodes", true},
                                {"Contact nodes", true},
                                {"Fixed nodes", true},
                                {"Volume by region", true},
                                {"Dihedral angles", true},
                                {"Radius ratio, min / mean", true}},
                               rows);
    return html::section("mesh", "Meshes", "", content + charts + rigid_table(page.inputs.patient_case));
}

std::string mechanics_section(const ReportPage& page) {
    const Case& patient_case = page.inputs.patient_case;
    std::vector<std::vector<std::string>> rows;
    for (const DeformableBody& body : patient_case.deformable_bodies)
        for (const RegionMaterial& entry : body.materials) {
            const auto label = std::ranges::find(body.mesh.region_names, entry.region, &Label::value);
            const double e = entry.material.youngs_modulus, nu = entry.material.poissons_ratio;
            rows.push_back(
                {escaped(body.name),
                 label != body.mesh.region_names.end() ? swatch(*label) : std::to_string(entry.region),
                 significant(1000 * e, 4), significant(nu, 4), significant(1000 * e / (2 * (1 + nu)), 3),
                 relaxation_text(relaxation_of(body, entry.region))});
        }
    std::string content;
    if (!rows.empty())
        content = html::table({{"Body"},
                               {"Region"},
                               {"Young’s modulus, kPa", true},
                               {"Poisson’s ratio", true},
                               {"Shear modulus, kPa", true},
                               {"Lost under a lasting strain"}},
                              rows);
    for (const DeformableBody& body : patient_case.deformable_bodies) {
        const double share = 100.0 * static_cast<double>(body.fixed_nodes.size()) /
                             static_cast<double>(std::max<std::size_t>(1, body.mesh.rest_positions.size()));
        const auto* blocks = std::get_if<HierarchicalCompliance>(&body.compliance);
        content += fmt::format(
            "<p><b>{}</b> is held at {} fixed nodes ({:.1f} % of all). It can be touched at {} contact "
            "nodes; "
            "its compliance, {}, takes {:.1f} MB and was condensed from {} unknowns of {} tetrahedra.</p>\n",
            escaped(body.name), count_of(body.fixed_nodes), share, count_of(body.contact_nodes),
            blocks ? fmt::format("in blocks of low rank to {:g}", blocks->accuracy) : "exact and dense",
            1e-6 * static_cast<double>(value_bytes(body.compliance)), grouped(body.certificate.free_dofs),
            body.element_order == ElementOrder::linear ? "linear" : "quadratic");
    }
    content += posture_sentences(patient_case.provenance);
    std::vector<html::Card> cards;
    for_each_field(haptic_fields, [&](const auto& field) {
        cards.push_back({title_of(field.name), significant(patient_case.haptics.*field.member), field.unit});
    });
    content += html::cards(cards);
    return html::section("mechanics", "Materials and boundary", "Isotropic linear elasticity.", content);
}

std::string certificate_section(const ReportPage& page) {
    const std::vector<MeasuredBody>& bodies = page.bodies;
    std::string content;
    for (const MeasuredBody& measured : bodies) {
        std::vector<std::vector<std::string>> rows;
        for (const Check& check : measured.checks)
            rows.push_back({check.limit.empty() ? ""
                            : check.holds       ? "<span class=\"yes\">✓</span>"
                                                : "<span class=\"no\">✗</span>",
                            check.name, check.value, check.limit, check.meaning});
        content +=
            body_title(bodies, measured.body) +
            html::table({{""}, {"Figure"}, {"Value", true}, {"Must be", true}, {"What it tells"}}, rows);
    }
    if (bodies.empty()) content = html::missing("The case has no deformable body, so nothing was condensed.");
    return html::section(
        "certificate", "Certificate",
        "Measured when the body was condensed. <code>palpate verify</code> solves again from "
        "the asset alone.",
        content);
}

}  // namespace palpate::report
