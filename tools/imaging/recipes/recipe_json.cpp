// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/imaging/recipes/recipe_json.hpp"

#include <nlohmann/json.hpp>

#include "formats/model/errors.hpp"

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

}  // namespace palpate::imaging
