// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/stages/requests/condense_request.hpp"

#include <charconv>
#include <cmath>

#include "formats/model/compliance.hpp"
#include "tools/cli/items.hpp"

namespace palpate::stages {
namespace {

using Json = nlohmann::ordered_json;

struct LabelledPair {
    std::string label;
    double first = 0, second = 0;
};

// LABEL:NUMBER,NUMBER
LabelledPair parse_pair(const std::string& option, const std::string& text, const std::string& expected,
                        const std::string& example) {
    const auto colon = text.rfind(':');
    const auto comma = text.find(',', colon == std::string::npos ? 0 : colon);
    double first = 0, second = 0;
    const auto number = [&](std::size_t begin, std::size_t end, double& value) {
        return std::from_chars(text.data() + begin, text.data() + end, value).ptr == text.data() + end &&
               std::isfinite(value);
    };
    if (colon == std::string::npos || comma == std::string::npos || !number(colon + 1, comma, first) ||
        !number(comma + 1, text.size(), second))
        throw UsageError({option + " " + text, "cannot be read", expected, "for example " + example});
    return {text.substr(0, colon), first, second};
}

LabelMaterial parse_material(const std::string& text) {
    const auto [label, modulus_kpa, ratio] =
        parse_pair("--material", text, "REGION:YOUNGS_MODULUS_KPA,POISSONS_RATIO", "liver:6.3,0.45");
    return {label, modulus_kpa, ratio};
}

LabelRelaxation parse_relaxation(const std::string& text) {
    const auto [label, share, time] = parse_pair("--relaxation", text, "REGION:SHARE,TIME", "liver:0.3,1");
    return {label, {.share = share, .time = time}};
}

LabelDensity parse_density(const std::string& text) {
    const auto colon = text.rfind(':');
    double density = 0;
    const char* const end = text.data() + text.size();
    if (colon == std::string::npos || std::from_chars(text.data() + colon + 1, end, density).ptr != end ||
        !std::isfinite(density))
        throw UsageError(
            {"--density " + text, "cannot be read", "REGION:KG_PER_M3", "for example liver:1060"});
    return {text.substr(0, colon), density};
}

NodePick pick_from(const std::string& words) {
    NodePick pick;
    pick.words = words;
    return pick;
}

}  // namespace

void to_json(Json& json, const LabelMaterial& material) {
    json = {{"label", material.label},
            {"youngs_modulus_kpa", material.youngs_modulus_kpa},
            {"poissons_ratio", material.poissons_ratio}};
}

void from_json(const Json& json, LabelMaterial& material) {
    cli::refuse_other_keys(json, {"label", "youngs_modulus_kpa", "poissons_ratio"});
    material = {json.at("label"), json.at("youngs_modulus_kpa"), json.at("poissons_ratio")};
}

void to_json(Json& json, const LabelRelaxation& relaxation) {
    json = {{"label", relaxation.label}};
    for_each_field(relaxation_fields,
                   [&](const auto& field) { json[key_of(field)] = relaxation.term.*field.member; });
}

void from_json(const Json& json, LabelRelaxation& relaxation) {
    cli::refuse_other_keys(json, {"label", "share", "time_s"});
    relaxation.label = json.at("label");
    for_each_field(relaxation_fields,
                   [&](const auto& field) { relaxation.term.*field.member = json.at(key_of(field)); });
}

void to_json(Json& json, const LabelDensity& density) {
    json = {{"label", density.label}, {"density_kg_m3", density.density_kg_m3}};
}

void from_json(const Json& json, LabelDensity& density) {
    cli::refuse_other_keys(json, {"label", "density_kg_m3"});
    density = {json.at("label"), json.at("density_kg_m3")};
}

void to_json(Json& json, const NodePick& pick) {
    json = Json::object();
    for (const auto& [key, name] : {std::pair{"touching", &pick.touching}, {"region", &pick.region}})
        if (!name->empty()) json[key] = *name;
    for (const auto& [key, numbers] : {std::pair{"box_mm", &pick.box_mm},
                                       {"sphere_mm", &pick.sphere_mm},
                                       {"plane_mm", &pick.plane_mm},
                                       {"facing", &pick.facing}})
        if (!numbers->empty()) json[key] = *numbers;
    if (!pick.nodes_file.empty()) json["nodes_file"] = pick.nodes_file.string();
}

void from_json(const Json& json, NodePick& pick) {
    cli::refuse_other_keys(json,
                           {"touching", "region", "box_mm", "sphere_mm", "plane_mm", "facing", "nodes_file"});
    pick = {};
    pick.touching = json.value("touching", "");
    pick.region = json.value("region", "");
    pick.box_mm = json.value("box_mm", std::vector<double>{});
    pick.sphere_mm = json.value("sphere_mm", std::vector<double>{});
    pick.plane_mm = json.value("plane_mm", std::vector<double>{});
    pick.facing = json.value("facing", std::vector<double>{});
    pick.nodes_file = json.value("nodes_file", "");
}

std::vector<std::filesystem::path> node_files(const CondenseRequest& request) {
    std::vector<std::filesystem::path> files;
    for (const auto* picks : {&request.fixed, &request.contact})
        for (const NodePick& pick : *picks)
            if (!pick.nodes_file.empty()) files.push_back(pick.nodes_file);
    return files;
}

void declare(cli::Command& command, CondenseRequest& request) {
    command.input("mesh", request.mesh, "tetrahedra with CellData 'region' (.vtu), LPS mm").required();
    command
        .items("--material", cli::item_list(request.materials, parse_material),
               "material of a region: REGION:YOUNGS_MODULUS,POISSONS_RATIO", "kPa, 1")
        .required();
    command.items(
        "--relaxation", cli::item_list(request.relaxation, parse_relaxation),
        "term of a region's relaxation, by ascending time: REGION:SHARE,TIME; the part SHARE of its "
        "modulus is lost with the time constant TIME",
        "1, s");
    command.items("--density", cli::item_list(request.densities, parse_density),
                  "density of a region, for a posture: REGION:DENSITY", "kg/m³");
    command.option("--scanned", request.scanned_posture,
                   "posture of the scan, whose shape gravity made: supine, prone, left_side, right_side "
                   "(lying on it), upright, or X,Y,Z, which way gravity points (LPS)");
    command.option("--posture", request.felt_posture,
                   "posture in which the body is felt: its shape there is made from the scan's");
    command.items("--fixed", cli::item_list(request.fixed, pick_from),
                  "rule that fixes nodes; several add up", "mm");
    command.items("--contact", cli::item_list(request.contact, pick_from),
                  "rule that picks the surface nodes that can be touched; several add up; without it, all "
                  "that are not fixed",
                  "mm");
    command.option("--element", request.element, "tetrahedra: linear (4 nodes) or quadratic (10 nodes)");
    command.option(
        "--representation", request.representation,
        "how to store C: dense (exact), hierarchical (compressed), or auto: dense if it fits --memory "
        "and --size");
    command
        .option("--accuracy", request.accuracy,
                "relative error that a hierarchical C may have: displacements under random contact loads")
        .range(CondenseRequest::finest_accuracy, HierarchicalCompliance::coarsest_accuracy);
    command
        .option("--memory", request.memory_gib,
                "memory that may be in use at once; 0: what the machine has left", "GiB", "memory_gib")
        .non_negative();
    command.option("--size", request.size_mib, "size that C may have in the file", "MiB", "size_mib")
        .positive();
    command.flag(
        "--discretisation-error", request.discretisation_error,
        "estimate what the elements themselves miss, by solving on richer ones (some eight times the "
        "unknowns)");
    command.option("--name", request.name, "name of the body; the mesh file's name by default");
    command.output("-o,--output", request.output, "condensed body (.body.h5)").required();
}

}  // namespace palpate::stages
