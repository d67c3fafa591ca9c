// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/commands/condense/arguments.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "formats/model/errors.hpp"

namespace palpate::condensation {
namespace {

RegionMaterial parse_material(const std::string& text, const TetMesh& mesh, const std::string& mesh_file) {
    const auto colon = text.rfind(':');
    const auto comma = text.find(',', colon == std::string::npos ? 0 : colon);
    double modulus_kpa = 0, ratio = 0;
    const auto number = [&](std::size_t begin, std::size_t end, double& value) {
        return std::from_chars(text.data() + begin, text.data() + end, value).ptr == text.data() + end &&
               std::isfinite(value);
    };
    if (colon == std::string::npos || comma == std::string::npos || !number(colon + 1, comma, modulus_kpa) ||
        !number(comma + 1, text.size(), ratio))
        throw UsageError({"--material " + text, "cannot be read", "REGION:YOUNGS_MODULUS_KPA,POISSONS_RATIO",
                          "for example liver:6.3,0.45"});
    const Label region = require_label(mesh.region_names, text.substr(0, colon), mesh_file);
    return {region.value, {.youngs_modulus = modulus_kpa * 1e-3, .poissons_ratio = ratio}};
}

}  // namespace

ElementOrder parse_element_order(const std::string& text) {
    for (const ElementOrder order : {ElementOrder::linear, ElementOrder::quadratic})
        if (text == name_of(order)) return order;
    throw UsageError({"--element " + text, "is no kind of element", "linear or quadratic", ""});
}

std::string name_of(ElementOrder order) {
    return order == ElementOrder::linear ? "linear" : "quadratic";
}

Representation parse_representation(const std::string& text) {
    if (text == "auto") return Representation::automatic;
    if (text == "dense") return Representation::dense;
    if (text == "hierarchical") return Representation::hierarchical;
    throw UsageError(
        {"--representation " + text, "is no way to store a compliance", "auto, dense or hierarchical", ""});
}

std::vector<RegionMaterial> parse_materials(const std::vector<std::string>& texts, const TetMesh& mesh,
                                            const std::string& mesh_file) {
    std::vector<RegionMaterial> materials;
    for (const std::string& text : texts) materials.push_back(parse_material(text, mesh, mesh_file));
    std::ranges::sort(materials, {}, &RegionMaterial::region);
    return materials;
}

std::vector<NodeRule> parse_node_rules(const std::string& option, const std::vector<std::string>& texts) {
    std::vector<NodeRule> rules;
    for (const std::string& text : texts) rules.push_back(parse_node_rule(option, text));
    return rules;
}

}  // namespace palpate::condensation
