// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cohort/patient_table.hpp"

#include <algorithm>
#include <cctype>
#include <fmt/format.h>
#include <fstream>
#include <map>
#include <set>

#include "formats/model/errors.hpp"
#include "formats/model/label_map.hpp"
#include "formats/model/reading/small_file.hpp"
#include "formats/model/reading/utf8.hpp"
#include "formats/toml_file/quoted.hpp"

namespace palpate::cohort {
namespace {

using case_builder::Override;

// Columns that stand for a key of the case file and hold text, mostly a path.
const std::map<std::string, std::string> text_columns{
    {"volume", "input.volume"}, {"labels", "input.labels"}, {"label_names", "input.label_names"}};

std::string stripped(const std::string& text) {
    const auto first = text.find_first_not_of(" \r"), last = text.find_last_not_of(" \r");
    return first == std::string::npos ? "" : text.substr(first, last - first + 1);
}

std::vector<std::string> cells_of(const std::string& line) {
    std::vector<std::string> cells;
    std::size_t start = 0;
    for (std::size_t end = 0; end != std::string::npos; start = end + 1) {
        end = line.find('\t', start);
        cells.push_back(stripped(line.substr(start, end == std::string::npos ? end : end - start)));
    }
    return cells;
}

// What a row says goes into JSON and TOML, which are UTF-8.
void require_utf8(const std::vector<std::string>& cells, const std::vector<std::string>& columns, int line,
                  const std::filesystem::path& path) {
    for (std::size_t i = 0; i < cells.size(); ++i) {
        const bool has_name = line > 1 && i < columns.size();
        if ((has_name && columns[i].starts_with('#')) || is_utf8(cells[i])) continue;
        throw InvalidInput(
            {fmt::format("{}:{}", path.string(), line),
             fmt::format("column {} is no UTF-8", has_name ? "'" + columns[i] + "'" : std::to_string(i + 1)),
             "", "save the table as UTF-8"});
    }
}

void require_columns(const std::vector<std::string>& columns, const std::filesystem::path& path) {
    const std::string where = path.string() + ":1";
    const std::vector<std::string> known{"patient", "case", "volume", "labels", "label_names", "problem"};
    std::set<std::string> seen;
    for (const std::string& column : columns) {
        if (column.starts_with('#')) continue;
        if (!seen.insert(column).second)
            throw InvalidInput({where, "has the column '" + column + "' twice", "", "leave one of them out"});
        if (std::ranges::find(known, column) == known.end() && column.find('.') == std::string::npos)
            throw InvalidInput(
                {where, "has a column '" + column + "'",
                 fmt::format("'{}', a dotted key of case files, or a name that begins with '#'",
                             fmt::join(known, "', '")),
                 fmt::format("nearest names: '{}'", fmt::join(nearest_names(column, known), "', '"))});
    }
    for (const char* needed : {"patient", "case"})
        if (!seen.contains(needed))
            throw InvalidInput({where, fmt::format("has no column '{}'", needed),
                                "columns set apart by tabs, named in the first line",
                                "see docs/many_patients.md"});
}

bool is_file_name(const std::string& name) {
    return !name.empty() && name.front() != '.' && name.front() != '-' && name.size() <= 100 &&
           std::ranges::all_of(name, [](unsigned char c) {
               return std::isalnum(c) != 0 || c == '_' || c == '-' || c == '.';
           });
}

// What is wrong with a row's name; empty if nothing.
std::string mistake_in_name(const Patient& patient, const std::set<std::string>& names_before) {
    if (!is_file_name(patient.name))
        return fmt::format(
            "patient '{}' is no safe file name (expected letters, digits, '_', '-' and '.'); "
            "choose another name",
            patient.name);
    if (patient.name == "index")
        return "patient 'index' is what the cohort's own page is called; choose another name";
    if (names_before.contains(patient.name))
        return fmt::format("patient '{}' stands in the table before; choose another name", patient.name);
    return "";
}

Patient patient_of(const std::vector<std::string>& columns, const std::vector<std::string>& cells, int line,
                   const std::filesystem::path& path) {
    Patient patient;
    patient.where = fmt::format("{}:{}", path.string(), line);
    for (std::size_t i = 0; i < columns.size() && i < cells.size(); ++i) {
        const std::string &column = columns[i], &cell = cells[i];
        if (column.starts_with('#') || cell.empty()) continue;
        if (column == "patient")
            patient.name = cell;
        else if (column == "case")
            patient.case_path = std::filesystem::absolute(path.parent_path() / cell).lexically_normal();
        else if (column == "problem")
            patient.mistake = cell;
        else if (const auto key = text_columns.find(column); key != text_columns.end())
            patient.overrides.push_back({key->second, toml_file::quoted(cell), path, line});
        else
            patient.overrides.push_back({column, cell, path, line});
    }
    return patient;
}

}  // namespace

std::vector<Patient> parse_patient_table(std::istream& stream, const std::filesystem::path& path) {
    std::vector<std::string> columns;
    std::vector<Patient> patients;
    std::set<std::string> names;
    std::string text;
    for (int line = 1; std::getline(stream, text); ++line) {
        if (line == 1 && text.starts_with("\xEF\xBB\xBF")) text.erase(0, 3);
        const std::vector<std::string> cells = cells_of(text);
        require_utf8(cells, columns, line, path);
        if (line == 1) {
            require_columns(columns = cells, path);
        } else if (std::ranges::any_of(cells, [](const std::string& cell) { return !cell.empty(); })) {
            Patient& patient = patients.emplace_back(patient_of(columns, cells, line, path));
            const std::string in_name = mistake_in_name(patient, names);
            patient.named = in_name.empty();
            if (!patient.named) patient.mistake = in_name;
            if (patient.mistake.empty() && patient.case_path.empty())
                patient.mistake = "column 'case' is empty; name the case file";
            if (cells.size() > columns.size())
                patient.mistake =
                    fmt::format("has {} cells where the first line has {}; set cells apart by one tab",
                                cells.size(), columns.size());
            if (!patient.mistake.empty()) patient.mistake = patient.where + ": " + patient.mistake;
            names.insert(patient.name);
        }
    }
    if (patients.empty())
        throw InvalidInput({path.string(), "has no patients",
                            "a line of column names and a line for each patient",
                            "see docs/many_patients.md"});
    return patients;
}

std::vector<Patient> read_patient_table(const std::filesystem::path& path) {
    constexpr std::uintmax_t most_bytes = 16 << 20;
    require_small_file(path, most_bytes);
    std::ifstream stream(path);
    return parse_patient_table(stream, path);
}

}  // namespace palpate::cohort
