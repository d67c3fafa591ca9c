// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/imaging/recipes/recipe_parameters.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <sstream>

#include "formats/model/errors.hpp"
#include "tools/imaging/files/read_image.hpp"

namespace palpate::imaging {
namespace {

using Kind = RecipeParameter::Kind;
using Range = RecipeParameter::Range;

// "seeds" is short for "seeds_mm".
std::string full_name(const std::string& parameter) {
    return parameter == "seeds" ? "seeds_mm" : parameter;
}

std::string culprit_of(const std::string& structure) {
    return "structure '" + structure + "'";
}

std::string joined(const std::vector<std::string>& names) {
    std::string text;
    for (const std::string& name : names) text += (text.empty() ? "'" : ", '") + name + "'";
    return text;
}

[[noreturn]] void refuse_value(const std::string& structure, const std::string& parameter,
                               const std::string& found, const std::string& expected) {
    throw InvalidInput(
        {culprit_of(structure), parameter + " is " + found, expected, "see 'palpate segment --help'"});
}

double parse_number(const std::string& structure, const std::string& parameter, std::string_view text) {
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size())
        refuse_value(structure, parameter, "'" + std::string(text) + "'", "a number");
    return value;
}

RecipeValue parse_value(const std::string& structure, const RecipeParameter& info, std::string text) {
    switch (info.kind) {
        case Kind::number:
            return parse_number(structure, info.name, text);
        case Kind::text:
        case Kind::file:
        case Kind::structure:
            return text;
        case Kind::flag:
            if (text == "yes" || text == "true") return true;
            if (text == "no" || text == "false") return false;
            refuse_value(structure, info.name, "'" + text + "'", "yes or no");
        case Kind::point:
        case Kind::points:
            break;
    }
    std::ranges::replace(text, ';', ',');
    std::vector<double> numbers;
    std::istringstream stream(text);
    for (std::string part; std::getline(stream, part, ',');)
        numbers.push_back(parse_number(structure, info.name, part));
    return numbers;
}

// What a value of that kind is called, and whether this is one.
std::pair<std::string, bool> expected_value(Kind kind, const RecipeValue& value) {
    switch (kind) {
        case Kind::number:
            return {"a number", std::holds_alternative<double>(value)};
        case Kind::point:
        case Kind::points:
            return {"numbers", std::holds_alternative<std::vector<double>>(value)};
        case Kind::flag:
            return {"yes or no", std::holds_alternative<bool>(value)};
        case Kind::text:
        case Kind::file:
        case Kind::structure:
            break;
    }
    return {"a text", std::holds_alternative<std::string>(value)};
}

void check_number(const std::string& structure, const RecipeParameter& info, double number) {
    const auto expect = [&](bool good, Range range) {
        if (!good) refuse_value(structure, info.name, fmt::format("{}", number), range_text(range));
    };
    expect(!std::isnan(number), Range::any);
    expect(info.range == Range::any || std::isfinite(number), Range::finite);
    expect(info.range != Range::not_negative || number >= 0, info.range);
    expect(info.range != Range::positive || number > 0, info.range);
}

template <typename Named>
std::string nearest(const std::string& name, const std::vector<Named>& candidates) {
    std::vector<std::string> names;
    for (const Named& candidate : candidates) names.push_back(candidate.name);
    return "nearest names: " + joined(nearest_names(name, names));
}

const Recipe& require_recipe(const StructureRecipe& structure) {
    if (const Recipe* recipe = find_recipe(structure.recipe)) return *recipe;
    throw InvalidInput({culprit_of(structure.name), "no recipe '" + structure.recipe + "'", "",
                        nearest(structure.recipe, recipes())});
}

const RecipeParameter& require_parameter(const StructureRecipe& structure, const std::string& name) {
    const Recipe& recipe = require_recipe(structure);
    if (const RecipeParameter* parameter = find_parameter(recipe, full_name(name))) return *parameter;
    throw InvalidInput({culprit_of(structure.name),
                        "recipe '" + structure.recipe + "' has no parameter '" + name + "'", "",
                        nearest(name, recipe.parameters)});
}

}  // namespace

void check_recipe(const StructureRecipe& structure) {
    require_recipe(structure);
    for (const auto& [name, value] : structure.parameters) {
        const RecipeParameter& info = require_parameter(structure, name);
        if (const auto [kind, is_one] = expected_value(info.kind, value); !is_one)
            refuse_value(structure.name, name, "of another kind", kind);
        if (const auto* numbers = std::get_if<std::vector<double>>(&value)) {
            if (numbers->empty() || numbers->size() % 3 != 0 ||
                (info.kind == Kind::point && numbers->size() != 3))
                refuse_value(structure.name, name, fmt::format("{} numbers", numbers->size()), "x, y, z");
            for (const double number : *numbers)
                if (!std::isfinite(number))
                    refuse_value(structure.name, name, fmt::format("{}", number), "finite numbers");
        }
        if (const auto* number = std::get_if<double>(&value)) check_number(structure.name, info, *number);
    }
}

StructureRecipe parse_structure(std::string_view text) {
    const auto malformed = [&](const std::string& found) {
        return UsageError({"--structure '" + as_utf8(text) + "'", found, "",
                           "write it as 'skull: recipe=bone threshold_hu=226'"});
    };
    const auto colon = text.find(':');
    if (colon == 0 || colon == std::string_view::npos) throw malformed("no name before a colon");
    StructureRecipe structure{std::string(text.substr(0, colon)), "", {}};
    if (as_utf8(structure.name) != structure.name) throw malformed("the name is no UTF-8 text");
    std::map<std::string, std::string> words;
    std::vector<std::string> order;
    std::istringstream stream{std::string(text.substr(colon + 1))};
    for (std::string word; stream >> word;) {
        const auto equals = word.find('=');
        if (equals == 0 || equals == std::string::npos)
            throw malformed("'" + word + "' is no parameter=value");
        if (!words.emplace(word.substr(0, equals), word.substr(equals + 1)).second)
            throw malformed("'" + word.substr(0, equals) + "' is given twice");
        order.push_back(word.substr(0, equals));
    }
    if (!words.contains("recipe")) throw malformed("no recipe");
    structure.recipe = words.extract("recipe").mapped();
    for (const auto& [name, value] : words)
        structure.parameters[full_name(name)] =
            parse_value(structure.name, require_parameter(structure, name), value);
    structure.order = order;
    check_recipe(structure);
    return structure;
}

Parameters::Parameters(const StructureRecipe& structure)
    : structure_(structure.name), values_(structure.parameters) {
    check_recipe(structure);
    if (auto seeds = values_.extract("seeds")) {
        seeds.key() = full_name("seeds");
        values_.insert(std::move(seeds));
    }
    for (const RecipeParameter& info : require_recipe(structure).parameters)
        if (!info.default_value.empty() && !values_.contains(info.name))
            values_[info.name] = parse_value(structure.name, info, info.default_value);
}

bool Parameters::has(const std::string& name) const {
    return values_.contains(name);
}

const RecipeValue& Parameters::value(const std::string& name) const {
    const auto found = values_.find(name);
    if (found == values_.end())
        throw InvalidInput({culprit_of(structure_), "has no '" + name + "'", "", "add it"});
    return found->second;
}

double Parameters::number(const std::string& name) const {
    return std::get<double>(value(name));
}

std::string Parameters::text(const std::string& name) const {
    return std::get<std::string>(value(name));
}

bool Parameters::flag(const std::string& name) const {
    return std::get<bool>(value(name));
}

Eigen::Vector3d Parameters::point(const std::string& name) const {
    return Eigen::Vector3d::Map(std::get<std::vector<double>>(value(name)).data());
}

std::vector<Eigen::Vector3d> Parameters::points(const std::string& name) const {
    std::vector<Eigen::Vector3d> points;
    if (!has(name)) return points;
    const auto& numbers = std::get<std::vector<double>>(value(name));
    for (std::size_t i = 0; i + 2 < numbers.size(); i += 3)
        points.emplace_back(numbers[i], numbers[i + 1], numbers[i + 2]);
    return points;
}

}  // namespace palpate::imaging
