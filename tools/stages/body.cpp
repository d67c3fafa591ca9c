// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/stages/body.hpp"

#include <algorithm>

#include "formats/model/errors.hpp"
#include "tools/fem/assembly/node_rules.hpp"
#include "tools/fem/certificate/discretisation_error.hpp"
#include "tools/fem/certificate/linear_limits.hpp"
#include "tools/fem/condensation/condense.hpp"
#include "tools/meshing/files/mesh_files.hpp"
#include "tools/stages/body_result.hpp"

namespace palpate::stages {
namespace {

using namespace fem;

ElementOrder element_order_of(const std::string& text) {
    for (const ElementOrder order : {ElementOrder::linear, ElementOrder::quadratic})
        if (text == name_of(order)) return order;
    throw UsageError({"--element " + text, "is no kind of element", "linear or quadratic", ""});
}

Representation representation_from(const std::string& text) {
    if (text == "auto") return Representation::automatic;
    if (text == "dense") return Representation::dense;
    if (text == "hierarchical") return Representation::hierarchical;
    throw UsageError(
        {"--representation " + text, "is no way to store a compliance", "auto, dense or hierarchical", ""});
}

std::vector<RegionMaterial> materials_of(const CondenseRequest& request, const TetMesh& mesh) {
    std::vector<RegionMaterial> materials;
    for (const LabelMaterial& material : request.materials)
        materials.push_back(
            {require_label(mesh.region_names, material.label, request.mesh.filename().string()).value,
             {.youngs_modulus = material.youngs_modulus_kpa * 1e-3,
              .poissons_ratio = material.poissons_ratio}});
    std::ranges::sort(materials, {}, &RegionMaterial::region);
    return materials;
}

std::vector<RegionDensity> densities_of(const CondenseRequest& request, const TetMesh& mesh) {
    std::vector<RegionDensity> densities;
    for (const LabelDensity& entry : request.densities) {
        if (!(entry.density_kg_m3 > 0))
            throw InvalidInput({"density of region '" + entry.label + "'",
                                std::to_string(entry.density_kg_m3), "a positive number, kg/m³",
                                "soft tissue has about 1 000"});
        densities.push_back(
            {require_label(mesh.region_names, entry.label, request.mesh.filename().string()).value,
             entry.density_kg_m3});
    }
    return densities;
}

// Brings the body from the posture of its scan into that in which it is felt.
std::optional<Sag> settle(const CondenseRequest& request, DeformableBody& body) {
    if (request.scanned_posture.empty() != request.felt_posture.empty())
        throw UsageError({"posture",
                          request.felt_posture.empty() ? "only the scan's is given" : "the scan's is missing",
                          "both, or none", "say --scanned and --posture, or both keys of [posture]"});
    const std::vector<RegionDensity> densities = densities_of(request, body.mesh);
    if (request.felt_posture.empty()) return std::nullopt;
    const Eigen::Vector3d change =
        gravity_in(request.felt_posture, "posture") - gravity_in(request.scanned_posture, "scanned posture");
    return move_at_rest(body, displacements_under(body, densities, change));
}

std::vector<RegionRelaxation> asked_relaxation(const CondenseRequest& request, const TetMesh& mesh) {
    std::vector<RegionRelaxation> relaxation;
    for (const auto& [label, term] : request.relaxation)
        relaxation.push_back(
            {require_label(mesh.region_names, label, request.mesh.filename().string()).value, term});
    std::ranges::stable_sort(relaxation, {}, &RegionRelaxation::region);
    return relaxation;
}

void require_sound_relaxation(const DeformableBody& body) {
    for (const Label& region : body.mesh.region_names)
        if (const auto error = relaxation_error(relaxation_of(body, region.value)))
            throw InvalidInput({"relaxation of region '" + region.name + "'",
                                error->name + " " + error->found, error->expected,
                                "correct 'relaxation' in the case file, or --relaxation"});
}

std::vector<NodeRule> rules_of(const std::string& option, const std::vector<NodePick>& picks) {
    std::vector<NodeRule> rules;
    for (const NodePick& pick : picks)
        if (!pick.words.empty())
            rules.push_back(parse_node_rule(option, pick.words));
        else if (!pick.touching.empty())
            rules.push_back({option + " touching:" + pick.touching, TouchingLabel{pick.touching}});
        else if (!pick.region.empty())
            rules.push_back({option + " region:" + pick.region, OfRegion{pick.region}});
        else if (!pick.nodes_file.empty())
            rules.push_back({option + " nodes:" + pick.nodes_file.string(), ListedNodes{pick.nodes_file}});
        else if (!pick.sphere_mm.empty())
            rules.push_back(sphere_rule(option, pick.sphere_mm));
        else if (!pick.plane_mm.empty())
            rules.push_back(plane_rule(option, pick.plane_mm));
        else if (!pick.facing.empty())
            rules.push_back(facing_rule(option, pick.facing));
        else
            rules.push_back(box_rule(option, pick.box_mm));
    return rules;
}

}  // namespace

MadeBody make_body(const CondenseRequest& request, int threads, const ProgressCallback& progress,
                   const std::function<void(const CondensationPlan&)>& announce) {
    const auto fixed = rules_of("--fixed", request.fixed), contact = rules_of("--contact", request.contact);
    DeformableBody body;
    body.element_order = element_order_of(request.element);
    const Representation representation = representation_from(request.representation);
    body.name = request.name.empty() ? request.mesh.stem().string() : request.name;
    body.mesh = meshing::read_tetrahedra(request.mesh);
    body.materials = materials_of(request, body.mesh);
    body.relaxation = asked_relaxation(request, body.mesh);
    require_sound_relaxation(body);
    const BoundarySurface boundary = boundary_surface(body.mesh);
    body.fixed_nodes = fixed_nodes_of(body.mesh, boundary, fixed);
    body.contact_nodes = contact_nodes_of(body.mesh, boundary, contact, body.fixed_nodes);
    progress("forecasting", 0);
    body = prepared_body(std::move(body));
    const std::optional<Sag> sag = settle(request, body);
    CondensationPlan plan = plan_condensation(body, {.representation = representation,
                                                     .accuracy = request.accuracy,
                                                     .memory_bytes = request.memory_gib * 0x1p30,
                                                     .size_bytes = request.size_mib * 0x1p20,
                                                     .threads = threads});
    announce(plan);
    body = condensed_body(std::move(body), plan, progress);
    if (request.discretisation_error) {
        progress("solving on richer elements", 0.95);
        body.certificate.discretisation_error = estimate_discretisation_error(body);
    }
    progress("pressing and lifting it far", 0.97);
    set_linear_limits(body.certificate, find_linear_limits(body));
    return {std::move(body), std::move(plan), sag};
}

}  // namespace palpate::stages
