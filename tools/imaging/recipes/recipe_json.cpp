// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/imaging/recipes/recipe_json.hpp"

#include <nlohmann/json.hpp>

#include "formats/model/errors.hpp"
#include "tools/imaging/files/shallow_json.hpp"

namespace palpate::imaging {

RecipeValue recipe_value(const nlohmann::ordered_json& value, const std::string& culprit) {
    if (value.is_boolean()) return value.get<bool>();
    if (value.is_number()) return value.get<double>();
    if (value.is_string()) return value.get<std::string>();
    std::vector<double> numbers;
    const nlohmann::ordered_json flat = value.flatten();
    for (const nlohmann::ordered_json& number : flat) {
        if (!value.is_array() || !number.is_number())
            throw InvalidInput({culprit, value.dump(), "a number, numbers, a text, true or false", ""});
        numbers.push_back(number.get<double>());
    }
    return numbers;
}

StructureRecipe structure_recipe(const std::string& name, const std::string& recipe,
                                 const nlohmann::ordered_json& parameters, const std::string& culprit) {
    StructureRecipe structure{name, recipe, {}};
    for (const auto& [key, value] : parameters.items()) {
        structure.parameters[key] = recipe_value(value, culprit + ": " + key);
        structure.order.push_back(key);
    }
    return structure;
}

std::vector<StructureRecipe> read_recipe_file(const std::filesystem::path& path) {
    using nlohmann::ordered_json;  // cleaning steps apply in the order written
    const auto document = read_json_file<ordered_json>(path);
    const auto refuse = [&](const std::string& found) {
        return InvalidInput({path.string(), found,
                             "[{\"name\": ..., \"recipe\": ..., \"parameters\": {...}}]",
                             "see 'palpate segment --help'"});
    };
    if (!document.is_array()) throw refuse("is not a JSON array, or nested more than 32 deep");
    std::vector<StructureRecipe> structures;
    for (const ordered_json& item : document) {
        if (!item.is_object()) throw refuse("holds " + item.dump());
        for (const auto& [key, value] : item.items())
            if (key != "name" && key != "recipe" && key != "parameters")
                throw refuse("has an unknown key '" + key + "'");
        if (!item.contains("name") || !item["name"].is_string()) throw refuse("a structure has no name");
        if (!item.contains("recipe") || !item["recipe"].is_string())
            throw refuse("a structure has no recipe");
        const std::string name = item["name"];
        const ordered_json parameters = item.value("parameters", ordered_json::object());
        if (!parameters.is_object()) throw refuse("parameters of '" + name + "' are no object");
        structures.push_back(structure_recipe(name, item["recipe"], parameters, path.string()));
    }
    return structures;
}

}  // namespace palpate::imaging
