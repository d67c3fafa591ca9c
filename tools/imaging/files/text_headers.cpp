// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/imaging/files/text_headers.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <functional>
#include <sstream>
#include <string>
#include <string_view>

#include "formats/model/errors.hpp"
#include "tools/imaging/files/read_image.hpp"
#include "tools/imaging/files/trimmed.hpp"

namespace palpate::imaging {
namespace {

[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& found,
                         const std::string& expected) {
    throw InvalidInput({path.string(), found, expected, "correct the header"});
}

bool is_space(unsigned char c) {
    return std::isspace(c) != 0;
}

// Reads lines until `is_last` says so.
void read_lines(const std::filesystem::path& path, const std::function<bool(const std::string&)>& is_last) {
    constexpr std::size_t longest = std::size_t{1} << 20;
    constexpr int most_lines = 8192;
    std::string head(longest + 1, '\0');
    std::ifstream file(path, std::ios::binary);
    file.read(head.data(), static_cast<std::streamsize>(head.size()));
    head.resize(static_cast<std::size_t>(file.gcount()));
    std::istringstream stream(head);
    int lines = 0;
    for (std::string line; std::getline(stream, line);) {
        if (++lines > most_lines || (stream.eof() && head.size() > longest))
            refuse(path, "has a header of more than 8192 lines or 1 MiB", "");
        if (is_last(line)) return;
    }
}

// A header made elsewhere may not choose what is read of this machine.
void require_in_folder(const std::filesystem::path& path, const std::string& name) {
    const auto folder = std::filesystem::absolute(path).parent_path().lexically_normal();
    const auto way = (folder / name).lexically_normal().lexically_relative(folder);
    if (way.empty() || *way.begin() == "..")
        refuse(path, "keeps its voxels outside its own folder", "a file beside the header or below it");
}

// Reading from a pipe or a device may have no end; "-" is the standard input.
void check_file_of_nrrd(const std::filesystem::path& path, const std::string& name) {
    std::error_code none;
    require_in_folder(path, name);
    const auto file = path.parent_path() / name;
    if (name == "-" || (std::filesystem::exists(file, none) && !std::filesystem::is_regular_file(file, none)))
        refuse(path, "keeps its voxels in what is no file", "a file");
}

// "slice%03d.raw 1 120 1": a file for each number.
void check_pattern_of_nrrd(const std::filesystem::path& path, const std::string& value) {
    constexpr double most_files = 65536;
    const std::size_t percent = value.rfind('%');
    if (percent == std::string::npos) return;
    std::istringstream words(value.substr(percent));
    std::string ending;
    double first = 0, last = 0, step = 1;
    if (!(words >> ending >> first >> last >> step)) return;
    if (!(std::abs((last - first) / step) <= most_files))
        refuse(path, "keeps its voxels in more than 65536 files", "");
    const std::size_t letter = ending.find_first_not_of("0123456789", 1);
    const std::string width = ending.substr(1, letter - 1);
    if (letter == std::string::npos || ending[letter] != 'd' || width.size() > 2 ||
        value.find('%') != percent)
        refuse(path, "names its files by a pattern of another kind", "one with %d");
    const std::size_t digits = width.empty() ? 0 : std::stoul(width);
    for (double number = first; step > 0 ? number <= last : number >= last; number += step) {
        const std::string text = std::to_string(static_cast<std::int64_t>(number));
        const std::string filled(digits - std::min(digits, text.size()), width.starts_with('0') ? '0' : ' ');
        check_file_of_nrrd(path, value.substr(0, percent) + filled + text + ending.substr(letter + 1));
    }
}

// What MetaIO takes for the name of a field where a line begins: up to a separator or a carriage return, and
// as a text of C up to a zero.
std::string name_of_field(std::string_view line) {
    line.remove_prefix(static_cast<std::size_t>(std::ranges::find_if_not(line, is_space) - line.begin()));
    line = line.substr(0, line.find_first_of(std::string_view("=:\r\0", 4)));
    while (!line.empty() && is_space(static_cast<unsigned char>(line.back()))) line.remove_suffix(1);
    return std::string(line);
}

// "256 256 90" in the field of that name; NrrdIO and MetaIO take 4 of "4.5" and 1 of "1e3".
void require_whole_numbers(const std::filesystem::path& path, const std::string& field,
                           const std::string& value) {
    if (value.find_first_not_of("0123456789 \t") != std::string::npos)
        refuse(path, "has " + field + " '" + as_utf8(value).substr(0, 40) + "'", "whole numbers");
}

// Of the types that MetaIO names, those of one number each.
void require_number_type(const std::filesystem::path& path, const std::string& type) {
    constexpr std::array<std::string_view, 12> numbers{
        "MET_CHAR", "MET_UCHAR", "MET_SHORT",     "MET_USHORT",     "MET_INT",   "MET_UINT",
        "MET_LONG", "MET_ULONG", "MET_LONG_LONG", "MET_ULONG_LONG", "MET_FLOAT", "MET_DOUBLE"};
    if (std::ranges::find(numbers, type) == numbers.end())
        refuse(path, "has ElementType '" + as_utf8(type).substr(0, 40) + "'",
               "a type of numbers, such as MET_SHORT or MET_FLOAT");
}

void check_dimensions(const std::filesystem::path& path, std::string line) {
    std::erase_if(line, is_space);
    const std::string value = line.substr(std::min(line.size(), std::size_t{6}));
    if (!line.starts_with("NDims") || value.size() != 1 || value[0] < '1' || value[0] > '9')
        refuse(path, "has NDims '" + as_utf8(value).substr(0, 40) + "'", "1 to 9");
}

}  // namespace

void require_short_nrrd_header(const std::filesystem::path& path) {
    bool lists_files = false;  // to the end of the header
    read_lines(path, [&](const std::string& line) {
        const std::string field = in_lower_case(line);
        if (lists_files && !trimmed(line).empty()) check_file_of_nrrd(path, trimmed(line));
        if (field.starts_with("sizes:"))
            require_whole_numbers(path, "sizes", trimmed(line.substr(line.find(':') + 1)));
        if (field.starts_with("data file:") || field.starts_with("datafile:")) {
            const std::string value = trimmed(line.substr(line.find(':') + 1));
            check_file_of_nrrd(path, value);
            check_pattern_of_nrrd(path, value);
            lists_files = value.starts_with("LIST");
        }
        return !lists_files && trimmed(line).empty();
    });
}

void require_short_metaimage_header(const std::filesystem::path& path) {
    constexpr std::size_t longest = 254;
    constexpr std::array<std::string_view, 5> texts{"Comment", "Name", "ObjectType", "ObjectSubType",
                                                    "AcquisitionDate"};
    std::string waiting;  // a name whose separator MetaIO seeks in the lines that follow
    read_lines(path, [&](const std::string& line) {
        const std::string name = waiting.empty() ? name_of_field(line) : waiting;
        const std::size_t separator = line.find_first_of("=:");
        if (line.find("NDims") != std::string::npos) check_dimensions(path, line);
        waiting = separator == std::string::npos ? name : "";
        const bool is_text = separator != std::string::npos && std::ranges::find(texts, name) != texts.end();
        if (name.size() > longest || (is_text && trimmed(line.substr(separator + 1)).size() > longest))
            refuse(path, "has a field, or a text in it, of more than 254 characters", "");
        if (separator == std::string::npos) return false;
        const std::string value = trimmed(line.substr(separator + 1));
        if (name == "DimSize") require_whole_numbers(path, name, value);
        if (name == "ElementType") require_number_type(path, value);
        if (name == "ElementDataFile") require_in_folder(path, value);
        return name == "ElementDataFile";
    });
}

}  // namespace palpate::imaging
