// SPDX-License-Identifier: Apache-2.0
#include "runtime/training/teacher/exercise_text.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <optional>
#include <sstream>
#include <string_view>
#include <toml++/toml.h>
#include <vector>

#include "formats/model/errors.hpp"

namespace palpate::training {
namespace {

// As TOML has a value, its quotes and escapes too.
template <typename Value>
std::string toml_of(const Value& value) {
    std::ostringstream stream;
    stream << toml::value<Value>(value);
    return stream.str();
}

std::string line_of(std::string_view key, const std::string& value) {
    return fmt::format("{} = {}\n", key, value);
}

std::string line_of(std::string_view key, const std::optional<double>& value) {
    return value ? line_of(key, toml_of(*value)) : "";
}

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) lines.push_back(line + "\n");
    return lines;
}

// Lines of a file, counted from 0; `end` is not among them.
struct LineRange {
    std::size_t begin, end;
};

void collect_headers(const toml::node& node, std::vector<std::size_t>& lines) {
    if (const toml::table* table = node.as_table(); table != nullptr && !table->is_inline()) {
        lines.push_back(table->source().begin.line);
        for (const auto& [key, value] : *table) collect_headers(value, lines);
    }
    if (const toml::array* array = node.as_array())
        for (const toml::node& item : *array) collect_headers(item, lines);
}

// Where a table of its own header stands: up to the next header, less the comments and empty lines before it.
LineRange range_of(const toml::table& table, const toml::table& document,
                   const std::vector<std::string>& lines) {
    std::vector<std::size_t> headers;
    for (const auto& [key, value] : document) collect_headers(value, headers);
    const std::size_t first = table.source().begin.line;  // from 1
    std::size_t end = lines.size();
    for (const std::size_t header : headers)
        if (header > first) end = std::min(end, header - 1);
    const auto is_of_next = [&](const std::string& line) {
        const auto letter = line.find_first_not_of(" \t\r\n");
        return letter == std::string::npos || line[letter] == '#';
    };
    while (end > first && is_of_next(lines[end - 1])) --end;
    return {first - 1, end};
}

}  // namespace

std::string exercise_text(const ExerciseRecipe& recipe) {
    const ExerciseRecipe usual;
    std::string text = "[[exercise]]\n" + line_of("name", toml_of(recipe.name)) +
                       line_of("task", toml_of(std::string(name_of(recipe.task))));
    if (recipe.title != recipe.name) text += line_of("title", toml_of(recipe.title));
    if (!recipe.instruction.empty()) text += line_of("instruction", toml_of(recipe.instruction));
    text += line_of("time_limit_s", recipe.time_limit) + line_of("least_force_n", recipe.least_force) +
            line_of("most_force_n", recipe.most_force) + line_of("tolerance_mm", recipe.tolerance) +
            line_of("hold_s", recipe.hold);
    if (recipe.count != usual.count) text += line_of("count", toml_of(recipe.count));
    if (recipe.seed != usual.seed) text += line_of("seed", toml_of(static_cast<std::int64_t>(recipe.seed)));
    if (recipe.spread != usual.spread) text += line_of("spread_mm", toml_of(recipe.spread));
    if (!recipe.region.empty()) text += line_of("region", toml_of(recipe.region));
    if (recipe.places.empty()) return text;
    text += "places_mm = [\n";
    for (const Eigen::Vector3d& p : recipe.places)
        text += fmt::format("    [{}, {}, {}],\n", toml_of(p.x()), toml_of(p.y()), toml_of(p.z()));
    return text + "]\n";
}

std::string with_exercise(const std::string& text, const ExerciseRecipe& recipe, const std::string& file) {
    toml::table document;
    try {
        document = toml::parse(text, file);
    } catch (const toml::parse_error& error) {
        throw InvalidInput({fmt::format("{}:{}", file, error.source().begin.line),
                            std::string(error.description()), "", "see docs/exercises.md"});
    }
    std::vector<std::string> lines = lines_of(text);
    std::optional<LineRange> old;
    if (const toml::array* exercises = document["exercise"].as_array())
        for (const toml::node& item : *exercises) {
            const toml::table* table = item.as_table();
            if (table == nullptr || table->is_inline())
                throw InvalidInput(
                    {file, "exercises stand in a list", "[[exercise]] tables", "write each of them as one"});
            if ((*table)["name"].value<std::string>() == recipe.name) old = range_of(*table, document, lines);
        }
    std::string before, after;
    for (std::size_t i = 0; i < lines.size(); ++i) {
        if (!old || i < old->begin) before += lines[i];
        if (old && i >= old->end) after += lines[i];
    }
    if (before.empty() && after.empty()) before = "schema = 1\n";
    if (!old) before += "\n";
    return before + exercise_text(recipe) + after;
}

}  // namespace palpate::training
