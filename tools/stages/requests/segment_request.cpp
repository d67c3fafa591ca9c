// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/stages/requests/segment_request.hpp"

#include <array>
#include <limits>
#include <utility>

#include "tools/cli/items.hpp"

namespace palpate::stages {
namespace {

StructureRequest structure_from(const std::string& words) {
    return {.words = words, .name = "", .recipe = ""};
}

// JSON has no infinite number, and a bound may be one: requests write it as the command line does.
constexpr std::array<std::pair<const char*, double>, 2> unbounded{
    {{"-inf", -std::numeric_limits<double>::infinity()}, {"inf", std::numeric_limits<double>::infinity()}}};

}  // namespace

void to_json(nlohmann::ordered_json& json, const StructureRequest& structure) {
    json = {{"name", structure.name}, {"recipe", structure.recipe}, {"parameters", structure.parameters}};
    for (auto& value : json["parameters"])
        for (const auto& [word, number] : unbounded)
            if (value == number) value = word;
}

void from_json(const nlohmann::ordered_json& json, StructureRequest& structure) {
    cli::refuse_other_keys(json, {"name", "recipe", "parameters"});
    structure = {.words = "", .name = json.at("name"), .recipe = json.at("recipe")};
    structure.parameters = json.value("parameters", nlohmann::ordered_json::object());
    for (auto& value : structure.parameters)
        for (const auto& [word, number] : unbounded)
            if (value == word) value = number;
}

void declare(cli::Command& command, SegmentRequest& request) {
    command.input("--volume", request.volume, "CT volume in HU, any format that 'palpate import' reads");
    command.input("--labels", request.labels, "label map that the recipe 'import' takes structures from");
    command.input("--recipes", request.recipes, "structures as JSON, before those of --structure");
    command.items("--structure", cli::item_list(request.structures, structure_from),
                  "one structure, 'name: recipe=... parameter=value ...'");
    command.output("--preview", request.preview,
                   "picture of the result to write as well (.png): slices with outlines");
    command.output("-o,--output", request.output, "label map (.seg.nrrd)").required();
}

}  // namespace palpate::stages
