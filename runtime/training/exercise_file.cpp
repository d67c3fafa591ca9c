// SPDX-License-Identifier: Apache-2.0
#include "runtime/training/exercise_file.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <fmt/format.h>
#include <iterator>
#include <utility>

#include "formats/records/shown_text.hpp"
#include "formats/toml_file/parse_file.hpp"
#include "formats/toml_file/table_reader.hpp"

namespace palpate::training {
namespace {

using Eigen::Vector3d;
using toml_file::TableReader;

constexpr auto see = "see docs/exercises.md";
constexpr std::size_t most_exercises = 1000;

Task task_of(TableReader& table) {
    const std::vector<std::string> names(std::begin(task_names), std::end(task_names));
    table.required<std::string>("task");
    const auto found = std::ranges::find(names, *table.choice("task", names));
    return static_cast<Task>(found - names.begin());
}

std::string name_of(TableReader& table) {
    const auto name = table.required<std::string>("name");
    const bool plain = !name.empty() && std::ranges::all_of(name, [](unsigned char letter) {
        return std::isalnum(letter) != 0 || letter == '-';
    });
    if (!plain)
        table.fail(table.node("name"), "name", "is '" + name + "'", "letters, digits and '-'",
                   "it names files");
    return name;
}

std::vector<Vector3d> places_of(TableReader& table) {
    std::vector<Vector3d> places;
    const auto fail = [&](const toml::node& node) {
        table.fail(node, "places_mm", "cannot be read", "a list of places, [[x, y, z], ...], LPS mm", see);
    };
    for (const toml::node& item : table.list("places_mm")) {
        const toml::array* numbers = item.as_array();
        if (numbers == nullptr || numbers->size() != 3) fail(item);
        Vector3d place;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const auto value = numbers->get(axis)->value<double>();
            if (!value || !std::isfinite(*value)) fail(item);
            place[static_cast<Eigen::Index>(axis)] = *value;
        }
        places.push_back(place);
    }
    return places;
}

// A whole number from `least` on.
std::int64_t whole_number(TableReader& table, const std::string& key, std::int64_t usual,
                          std::int64_t least) {
    const std::int64_t value = table.optional<std::int64_t>(key).value_or(usual);
    if (value < least || value > 1000)
        table.fail(table.node(key), key, fmt::format("is {}", value), fmt::format("{} to 1000", least));
    return value;
}

ExerciseRecipe recipe_of(TableReader table) {
    ExerciseRecipe recipe;
    recipe.written_at = table.position_of(table.raw());
    recipe.name = name_of(table);
    recipe.task = task_of(table);
    recipe.title = table.optional<std::string>("title").value_or(recipe.name);
    recipe.instruction = table.optional<std::string>("instruction").value_or("");
    recipe.time_limit = table.positive("time_limit_s");
    recipe.least_force = table.positive("least_force_n");
    recipe.most_force = table.positive("most_force_n");
    if (recipe.least_force && recipe.most_force && *recipe.least_force >= *recipe.most_force)
        table.fail(table.node("least_force_n"), "least_force_n", fmt::format("is {}", *recipe.least_force),
                   fmt::format("less than most_force_n, {}", *recipe.most_force));
    if (recipe.task != Task::free) recipe.tolerance = table.positive("tolerance_mm");
    if (recipe.task == Task::touch || recipe.task == Task::retract) recipe.hold = table.positive("hold_s");
    if (recipe.task == Task::touch) {
        recipe.count = whole_number(table, "count", recipe.count, 1);
        recipe.seed = static_cast<std::uint64_t>(whole_number(table, "seed", 1, 0));
    }
    if (recipe.task == Task::touch || recipe.task == Task::trace)
        recipe.spread = table.positive("spread_mm").value_or(recipe.spread);
    if (recipe.task == Task::find) recipe.region = table.optional<std::string>("region").value_or("");
    if (recipe.task != Task::find && recipe.task != Task::free) recipe.places = places_of(table);
    if (recipe.task == Task::guide && recipe.places.size() < 2)
        table.fail(table.node("places_mm"), "places_mm", fmt::format("has {} gates", recipe.places.size()),
                   "2 or more", "a passage cannot be guessed");
    if (recipe.task == Task::trace && recipe.places.size() == 1)
        table.fail(table.node("places_mm"), "places_mm", "has one point", "none, or 2 or more", see);
    if (recipe.task == Task::retract && !recipe.places.empty() && recipe.places.size() != 3)
        table.fail(table.node("places_mm"), "places_mm", fmt::format("has {} places", recipe.places.size()),
                   "none, or 3", "the rim, where closed tips meet there, and where to draw those");
    table.refuse_unknown();
    return recipe;
}

}  // namespace

std::vector<ExerciseRecipe> read_exercises(const std::filesystem::path& file) {
    const toml::table document = toml_file::parse_file(file, see);
    TableReader root(document, file.string(), "");
    if (const auto schema = root.required<std::int64_t>("schema"); schema != 1)
        root.fail(root.node("schema"), "schema", fmt::format("is {}", schema), "1", "");
    std::vector<ExerciseRecipe> recipes;
    std::vector<TableReader> tables = root.tables("exercise");
    if (tables.size() > most_exercises)
        root.fail(document, "exercise", fmt::format("is there {} times", tables.size()),
                  fmt::format("{} at most", most_exercises), "share them out among files");
    for (TableReader& table : tables) {
        recipes.push_back(recipe_of(table));
        const auto same = std::ranges::count(recipes, recipes.back().name, &ExerciseRecipe::name);
        if (same > 1)
            table.fail(table.node("name"), "name", "is '" + recipes.back().name + "' a second time",
                       "another name", "");
    }
    root.refuse_unknown();
    if (recipes.empty()) root.fail(document, "exercise", "is missing", "[[exercise]] tables", see);
    return recipes;
}

std::string usual_instruction(Task task) {
    switch (task) {
        case Task::touch:
            return shown_text("Press each yellow mark until it turns grey, with the force in the blue band");
        case Task::find:
            return shown_text(
                "Feel for what is harder than the rest. K: a point of its border. Stay on it, press M");
        case Task::guide:
            return shown_text(
                "Lead the tip through the rings, not against the wall. V: the view from the tip");
        case Task::trace:
            return shown_text("Follow the line from the ball on, with the force in the blue band");
        case Task::retract:
            return shown_text(
                "Jaws over the rim at the ball, J closes them. Draw it into the ring, keep it, J lets go");
        case Task::free:
            break;
    }
    return shown_text("Take your time. E ends and shows what you did.");
}

std::vector<ExerciseRecipe> standard_exercises(bool with_forceps) {
    std::vector<ExerciseRecipe> recipes;
    const auto add = [&](Task task, std::string title, std::optional<double> time_limit) {
        ExerciseRecipe recipe;
        recipe.name = name_of(task);
        recipe.title = std::move(title);
        recipe.instruction = usual_instruction(task);
        recipe.task = task;
        recipe.time_limit = time_limit;
        recipes.push_back(std::move(recipe));
    };
    if (with_forceps) {
        add(Task::retract, shown_text("Hold tissue back"), 120);
        add(Task::free, shown_text("Free exploration"), std::nullopt);
        return recipes;
    }
    add(Task::touch, shown_text("Touch the marks"), 180);
    add(Task::find, shown_text("Find what is hidden"), 300);
    add(Task::trace, shown_text("Follow the line"), 180);
    add(Task::free, shown_text("Free exploration"), std::nullopt);
    return recipes;
}

}  // namespace palpate::training
