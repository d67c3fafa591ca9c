// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/imaging/recipe_parameters.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <sstream>

#include "formats/model/errors.hpp"
#include "tools/imaging/read_image.hpp"

namespace palpate {
namespace {

using Kind = RecipeParameterInfo::Kind;
using Table = std::map<std::string, std::vector<RecipeParameterInfo>>;

std::vector<RecipeParameterInfo> region_parameters() {
    return {{"center_mm", Kind::numbers, "mm", "", "centre x, y, z of the sphere it is cut to"},
            {"radius_mm", Kind::number, "mm", "", "radius of that sphere"},
            {"box_min_mm", Kind::numbers, "mm", "", "lowest x, y, z of the box it is cut to"},
            {"box_max_mm", Kind::numbers, "mm", "", "highest x, y, z of that box"}};
}

std::vector<RecipeParameterInfo> seed_parameters() {
    return {{"seeds_mm", Kind::numbers, "mm", "", "points x, y, z inside it (LPS); 'seeds' for short"},
            {"seeds_file", Kind::text, "", "",
             "3D Slicer points (.mrk.json, .fcsv): those labelled as the structure, or all if they share a "
             "label"},
            {"scribbles", Kind::text, "", "", "label map with strokes, those labelled as the structure"}};
}

// Applied in the order written, after the recipe; in this order where none is known.
std::vector<RecipeParameterInfo> cleaning_parameters(const std::string& smallest_ml = "0",
                                                     const std::string& solid = "no",
                                                     const std::string& smooth_mm = "0") {
    return {{"close_mm", Kind::number, "mm", "0", "fill gaps that a ball of this radius does not fit into"},
            {"open_mm", Kind::number, "mm", "0", "remove what a ball of this radius does not fit into"},
            {"fill_holes", Kind::flag, "", solid, "fill enclosed background"},
            {"min_component_ml", Kind::number, "ml", smallest_ml, "drop smaller pieces"},
            {"keep_largest", Kind::flag, "", solid, "keep the largest piece only"},
            {"smooth_mm", Kind::number, "mm", smooth_mm, "round details below this size off, volume kept"}};
}

const std::vector<RecipeParameterInfo> import_parameters{
    {"label", Kind::text, "", "",
     "name or value in the label map, * for all of them [default: the structure's name]"},
    {"file", Kind::text, "", "", "label map to read [default: the one given with the volume]"}};

Table own_parameters() {
    return {
        {"bone",
         {{"threshold_hu", Kind::number, "HU", "226", "bone is at least this dense; 0 finds it by itself"},
          {"separation_mm", Kind::number, "mm", "4", "ball that cuts table and head rest off the body"}}},
        {"airway",
         {{"threshold_hu", Kind::number, "HU", "-400", "air is below"},
          {"opening_mm", Kind::number, "mm", "5",
           "openings to the outside that a ball of this radius does not pass count as closed"}}},
        {"nasopharynx",
         {{"air", Kind::text, "", "airway", "structure the wall encloses"},
          {"thickness_mm", Kind::number, "mm", "6", "depth of the wall from the air"},
          {"lower_hu", Kind::number, "HU", "-400", "soft tissue is at least this dense"},
          {"upper_hu", Kind::number, "HU", "225", "soft tissue is at most this dense"},
          {"smoothing_mm", Kind::number, "mm", "1", "gaps and spikes below this radius vanish"}}},
        {"liver",
         {{"tolerance_hu", Kind::number, "HU", "25", "grey values may be so far off the local mean"},
          {"drift_hu", Kind::number, "HU", "20", "the local mean may be so far off that at the seeds"},
          {"neck_mm", Kind::number, "mm", "6", "where no ball of this radius passes, the liver ends"},
          {"gap_mm", Kind::number, "mm", "4", "vessels, lesions and clefts below this radius are filled"},
          {"largest_ml", Kind::number, "ml", "4000", "more than this is a leak"}}},
        {"tumour",
         {{"inside", Kind::text, "", "", "structure whose voxels it takes"},
          {"margin_mm", Kind::number, "mm", "2",
           "how far it may reach beyond the voxels of that structure"}}},
        {"vessels",
         {{"inside", Kind::text, "", "", "structure whose voxels they take [default: background only]"},
          {"contrast_hu", Kind::number, "HU", "25", "they are so much brighter than their surroundings"},
          {"max_radius_mm", Kind::number, "mm", "8", "what a larger ball fits into is no vessel"}}},
        {"grow-from-seeds",
         {{"tolerance", Kind::number, "", "3",
           "it stops at grey values so many standard deviations off its seeds' mean"}}},
        {"threshold",
         {{"lower_hu", Kind::number, "HU", "-inf", "lowest value"},
          {"upper_hu", Kind::number, "HU", "inf", "highest value"}}},
        {"import", import_parameters},
        {"brain", import_parameters},
        {"sphere",
         {{"inside", Kind::text, "", "", "structure whose voxels it takes"},
          {"center_mm", Kind::numbers, "mm", "", "centre x, y, z"},
          {"radius_mm", Kind::number, "mm", "", "radius"}}}};
}

Table make_table() {
    const auto append = [](std::vector<RecipeParameterInfo>& to,
                           const std::vector<RecipeParameterInfo>& more) {
        to.insert(to.end(), more.begin(), more.end());
    };
    Table table = own_parameters();
    for (auto& [recipe, parameters] : table) {
        if (recipe == "sphere") continue;
        if (takes_seeds(recipe)) append(parameters, seed_parameters());
        append(parameters, region_parameters());
        if (recipe == "nasopharynx") continue;
        const bool solid = recipe == "brain" || recipe == "tumour";
        append(parameters, cleaning_parameters(recipe == "bone"      ? "1"
                                               : recipe == "vessels" ? "0.05"
                                                                     : "0",
                                               solid ? "yes" : "no", recipe == "liver" ? "3" : "0"));
    }
    return table;
}

const Table& table() {
    static const Table recipes = make_table();
    return recipes;
}

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

RecipeValue parse_value(const std::string& structure, const RecipeParameterInfo& info, std::string text) {
    switch (info.kind) {
        case Kind::number:
            return parse_number(structure, info.name, text);
        case Kind::text:
            return text;
        case Kind::flag:
            if (text == "yes" || text == "true") return true;
            if (text == "no" || text == "false") return false;
            refuse_value(structure, info.name, "'" + text + "'", "yes or no");
        case Kind::numbers:
            break;
    }
    std::ranges::replace(text, ';', ',');
    std::vector<double> numbers;
    std::istringstream stream(text);
    for (std::string part; std::getline(stream, part, ',');)
        numbers.push_back(parse_number(structure, info.name, part));
    return numbers;
}

bool is_of(Kind kind, const RecipeValue& value) {
    return (kind == Kind::number && std::holds_alternative<double>(value)) ||
           (kind == Kind::numbers && std::holds_alternative<std::vector<double>>(value)) ||
           (kind == Kind::text && std::holds_alternative<std::string>(value)) ||
           (kind == Kind::flag && std::holds_alternative<bool>(value));
}

void check_number(const std::string& structure, const RecipeParameterInfo& info, double number) {
    const auto expect = [&](bool good, const char* expected) {
        if (!good) refuse_value(structure, info.name, fmt::format("{}", number), expected);
    };
    const bool may_be_infinite = info.name == "lower_hu" || info.name == "upper_hu";
    expect(!std::isnan(number), "a number");
    expect(may_be_infinite || std::isfinite(number), "a finite number");
    if (info.unit == "mm" || info.unit == "ml" || info.name == "drift_hu" || info.name == "contrast_hu")
        expect(number >= 0, "0 or more");
    if (info.name == "tolerance" || info.name == "tolerance_hu") expect(number > 0, "above 0");
}

const RecipeParameterInfo& require_parameter(const StructureRecipe& structure, const std::string& name) {
    const auto found = table().find(structure.recipe);
    if (found == table().end())
        throw InvalidInput({culprit_of(structure.name), "no recipe '" + structure.recipe + "'", "",
                            "nearest names: " + joined(nearest_names(structure.recipe, recipe_names()))});
    std::vector<std::string> names;
    for (const RecipeParameterInfo& info : found->second) {
        if (info.name == full_name(name)) return info;
        names.push_back(info.name);
    }
    throw InvalidInput({culprit_of(structure.name),
                        "recipe '" + structure.recipe + "' has no parameter '" + name + "'", "",
                        "nearest names: " + joined(nearest_names(name, names))});
}

}  // namespace

bool takes_seeds(const std::string& recipe) {
    return std::ranges::count(std::array{"airway", "grow-from-seeds", "liver", "tumour", "vessels"}, recipe) >
           0;
}

std::vector<std::string> cleaning_steps(const StructureRecipe& structure) {
    std::vector<std::string> steps, written;
    for (const RecipeParameterInfo& info : cleaning_parameters())
        if (std::ranges::count(structure.order, info.name) == 0) steps.push_back(info.name);
    for (const std::string& name : structure.order)
        if (std::ranges::count(steps, name) == 0 &&
            std::ranges::count(cleaning_parameters(), name, &RecipeParameterInfo::name) > 0)
            written.push_back(name);
    steps.insert(steps.end(), written.begin(), written.end());
    return steps;
}

std::vector<std::string> recipe_names() {
    std::vector<std::string> names;
    for (const auto& [name, parameters] : table()) names.push_back(name);
    return names;
}

std::vector<RecipeParameterInfo> recipe_parameters(const std::string& recipe) {
    const auto found = table().find(recipe);
    if (found == table().end())
        throw InvalidInput({"recipe", "'" + recipe + "' is unknown", "",
                            "nearest names: " + joined(nearest_names(recipe, recipe_names()))});
    return found->second;
}

void check_recipe(const StructureRecipe& structure) {
    if (!table().contains(structure.recipe)) require_parameter(structure, "");
    for (const auto& [name, value] : structure.parameters) {
        const RecipeParameterInfo& info = require_parameter(structure, name);
        const std::string kind = info.kind == Kind::number    ? "a number"
                                 : info.kind == Kind::numbers ? "numbers"
                                 : info.kind == Kind::text    ? "a text"
                                                              : "yes or no";
        if (!is_of(info.kind, value)) refuse_value(structure.name, name, "of another kind", kind);
        if (const auto* numbers = std::get_if<std::vector<double>>(&value)) {
            if (numbers->empty() || numbers->size() % 3 != 0 ||
                (info.name != "seeds_mm" && numbers->size() != 3))
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
    for (const RecipeParameterInfo& info : recipe_parameters(structure.recipe))
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

}  // namespace palpate
