// SPDX-License-Identifier: Apache-2.0
#include "formats/provenance/cautions.hpp"

#include <nlohmann/json.hpp>

namespace palpate::provenance {
namespace {

using Json = nlohmann::ordered_json;

Json at(const Json& from, const char* place) {
    const Json::json_pointer pointer(place);
    return from.is_object() && from.contains(pointer) ? from[pointer] : Json();
}

}  // namespace

std::vector<std::string> cautions_in(const std::string& provenance) {
    const Json json = Json::parse(provenance, nullptr, false);
    std::vector<std::string> cautions;
    const auto add = [&](const Json& texts, const std::string& before, const std::string& after) {
        if (!texts.is_array()) return;
        for (const Json& text : texts)
            if (text.is_string()) cautions.push_back(before + text.get<std::string>() + after);
    };
    add(at(json, "/build/cautions"), "", "");
    for (const Json& mesh : at(json, "/meshes"))
        add(at(mesh, "/at_image_edge"), "\u2018",
            "\u2019 reaches the image\u2019s edge: what lies beyond it is missing.");
    add(at(json, "/notes"), "", "");
    return cautions;
}

}  // namespace palpate::provenance
