// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <sstream>
#include <vector>

#include "formats/model/errors.hpp"
#include "formats/model/reading/small_file.hpp"
#include "tools/imaging/files/label_names.hpp"
#include "tools/imaging/files/read_image.hpp"
#include "tools/imaging/files/shallow_json.hpp"
#include "tools/imaging/files/totalsegmentator_labels.hpp"
#include "tools/imaging/files/trimmed.hpp"

namespace palpate::imaging {
namespace {

constexpr std::uintmax_t most_bytes = 16 << 20;

using Colour = std::optional<std::array<float, 3>>;

template <typename Number>
std::optional<Number> number_of(std::string_view text) {
    Number number{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
    return number;
}

std::vector<std::string> split(const std::string& line, char separator) {
    std::vector<std::string> parts;
    std::istringstream stream(line);
    for (std::string part; std::getline(stream, part, separator);) parts.push_back(trimmed(part));
    return parts;
}

// Three whole numbers of 0 ... 255.
Colour byte_colour(std::span<const std::string> words) {
    if (words.size() < 3) return std::nullopt;
    std::array<float, 3> rgb{};
    for (std::size_t i = 0; i < 3; ++i) {
        const auto channel = number_of<int>(words[i]);
        if (!channel || *channel < 0 || *channel > 255) return std::nullopt;
        rgb[i] = static_cast<float>(*channel) / 255.0F;
    }
    return rgb;
}

// "#ff8000".
Colour hex_colour(const std::string& text) {
    if (text.size() != 7 || text[0] != '#') return std::nullopt;
    unsigned rgb = 0;
    const auto [end, error] = std::from_chars(text.data() + 1, text.data() + 7, rgb, 16);
    if (error != std::errc{} || end != text.data() + 7) return std::nullopt;
    return std::array{static_cast<float>(rgb >> 16) / 255.0F, static_cast<float>(rgb >> 8 & 255U) / 255.0F,
                      static_cast<float>(rgb & 255U) / 255.0F};
}

// Adds an entry; false if the value or the name cannot be one. Background is no entry.
bool add(LabelTable& table, std::optional<std::int32_t> value, const std::string& name,
         const Colour& colour) {
    if (!value || *value < 0 || *value > 65535 || name.empty()) return false;
    if (*value > 0) table[*value] = {*value, as_utf8(name), colour.value_or(default_label_colour(*value))};
    return true;
}

// One line of any of the tables in words: value name [R G B [A]], value name code, or value R G B A visible
// mesh "name". A name may have blanks.
bool add_line(LabelTable& table, const std::string& line) {
    std::vector<std::string> words;
    const auto quote = line.find('"');
    std::istringstream stream(line.substr(0, quote));
    for (std::string word; stream >> word;) words.push_back(word);
    if (words.empty()) return false;
    const auto value = number_of<std::int32_t>(words[0]);
    if (quote != std::string::npos) {
        const auto end = line.find('"', quote + 1);
        if (end == std::string::npos) return false;
        return add(table, value, trimmed(line.substr(quote + 1, end - quote - 1)),
                   byte_colour(std::span(words).subspan(1)));
    }
    auto first = words.end();  // of the numbers behind the name
    while (first - words.begin() > 1 && number_of<double>(*(first - 1))) --first;
    if (words.end() - first > 4) first = words.end() - 4;  // a name that ends with a number, R G B A
    const std::span<const std::string> numbers(first, words.end());
    if (first - words.begin() < 2 || number_of<double>(words[1]) || numbers.size() == 2) return false;
    // A single number is a column of codes, or the end of a name: "vertebra 5".
    if (const auto code = numbers.size() == 1 ? number_of<std::int32_t>(numbers[0]) : value;
        code != value && (!code || *code < 1000))
        return false;
    return add(table, value, fmt::format("{}", fmt::join(words.begin() + 1, first, " ")),
               byte_colour(numbers));
}

// Where BIDS puts what; nothing if the line is no header of such a table.
struct Columns {
    std::size_t index = 0, name = 0;
    std::optional<std::size_t> colour;
};
std::optional<Columns> columns_of(const std::string& line) {
    const std::vector<std::string> titles = split(line, '\t');
    const auto find = [&](const char* title) -> std::optional<std::size_t> {
        const auto found = std::ranges::find(titles, title);
        if (found == titles.end()) return std::nullopt;
        return static_cast<std::size_t>(found - titles.begin());
    };
    const auto index = find("index"), name = find("name");
    if (!index || !name) return std::nullopt;
    return Columns{*index, *name, find("color")};
}

bool add_row(LabelTable& table, const std::string& line, const Columns& columns) {
    const std::vector<std::string> cells = split(line, '\t');
    if (cells.size() <= std::max(columns.index, columns.name)) return false;
    const Colour colour =
        columns.colour && *columns.colour < cells.size() ? hex_colour(cells[*columns.colour]) : std::nullopt;
    return add(table, number_of<std::int32_t>(cells[columns.index]), cells[columns.name], colour);
}

// {"5": "liver"}, or {"labels": {"liver": 5}} and mixtures of the two.
LabelTable json_table(const std::string& text, const std::filesystem::path& path) {
    const InvalidInput malformed({path.string(), "is no JSON label table",
                                  "{\"5\": \"liver\"} or {\"labels\": {\"liver\": 5}}", "correct the file"});
    nlohmann::json document = shallow_json(text);
    if (document.is_object() && document.contains("labels")) {
        nlohmann::json labels = std::move(document["labels"]);
        document = std::move(labels);
    }
    if (!document.is_object()) throw malformed;
    LabelTable table;
    for (const auto& [key, item] : document.items()) {
        const bool good =
            item.is_number_integer()
                ? add(table, number_of<std::int32_t>(item.dump()), key, {})
                : item.is_string() && add(table, number_of<std::int32_t>(key), item.get<std::string>(), {});
        if (!good) throw malformed;
    }
    return table;
}

std::string attribute(std::string_view tag, std::string_view name) {
    const auto start = tag.find(std::string(name) + "=\"");
    if (start == std::string_view::npos) return {};
    const auto from = start + name.size() + 2;
    return std::string(tag.substr(from, tag.find('"', from) - from));
}

}  // namespace

LabelTable parse_xml_label_table(std::string_view xml) {
    LabelTable table;
    constexpr std::size_t longest = 4096;  // of a label with its attributes
    for (std::size_t at = xml.find("<Label "), end = 0; at != std::string_view::npos;
         at = xml.find("<Label ", end)) {
        const auto close = xml.find('>', at);
        end = xml.find("</Label>", at);
        if (close == std::string_view::npos || end == std::string_view::npos || close > end) break;
        if (end - at > longest) continue;
        const std::string_view tag = xml.substr(at, close - at);
        std::string name(xml.substr(close + 1, end - close - 1));
        if (const auto data = name.find("<![CDATA["), stop = name.find("]]>");
            data != std::string::npos && stop != std::string::npos && stop > data)
            name = name.substr(data + 9, stop - data - 9);
        std::array<float, 3> rgb{};
        bool coloured = true;
        for (std::size_t i = 0; i < 3; ++i) {
            const auto channel = number_of<float>(attribute(tag, std::array{"Red", "Green", "Blue"}[i]));
            coloured = coloured && channel && *channel >= 0 && *channel <= 1;
            rgb[i] = channel.value_or(0);
        }
        add(table, number_of<std::int32_t>(attribute(tag, "Key")), trimmed(name),
            coloured ? Colour(rgb) : std::nullopt);
    }
    return table;
}

LabelTable read_label_table(const std::filesystem::path& path) {
    require_small_file(path, most_bytes);
    std::ifstream stream(path);
    if (!stream) throw InvalidInput({path.string(), "cannot be read", "", "check the path"});
    const std::string mark = "\xEF\xBB\xBF";  // of UTF-8
    for (std::size_t i = 0; i < mark.size() && stream.peek() == static_cast<unsigned char>(mark[i]); ++i)
        stream.get();
    if (const char first = static_cast<char>((stream >> std::ws).peek()); first == '{' || first == '[')
        return json_table({std::istreambuf_iterator<char>(stream), {}}, path);
    LabelTable table;
    std::optional<Columns> columns;
    int number = 0;
    for (std::string line; std::getline(stream, line);) {
        ++number;
        if (trimmed(line).empty() || trimmed(line)[0] == '#') continue;
        if (table.empty() && !columns) {
            columns = columns_of(line);
            if (columns) continue;
        }
        if (columns ? add_row(table, line, *columns) : add_line(table, line)) continue;
        throw InvalidInput(
            {fmt::format("{}:{}", path.string(), number), "'" + trimmed(line).substr(0, 60) + "'",
             "value and name, as in a .ctbl, ITK-SNAP, FreeSurfer or BIDS table", "correct the line"});
    }
    if (table.empty()) throw InvalidInput({path.string(), "names no label", "", "choose a label table"});
    return table;
}

std::string bids_label_table(std::span<const Label> labels) {
    std::string table = "index\tname\tcolor\n";
    for (const Label& label : labels) {
        std::string name = label.name;
        for (const char between : {'\t', '\n', '\r'}) std::ranges::replace(name, between, ' ');
        std::array<long, 3> rgb{};
        std::ranges::transform(label.colour, rgb.begin(), [](float channel) {
            return std::lround(255 * std::clamp(channel, 0.0F, 1.0F));
        });
        table +=
            fmt::format("{}\t{}\t#{:02x}{:02x}{:02x}\n", label.value, trimmed(name), rgb[0], rgb[1], rgb[2]);
    }
    return table;
}

LabelTable totalsegmentator_table(std::string_view task) {
    LabelTable table;
    std::set<std::string> tasks;
    std::istringstream stream{std::string(totalsegmentator_labels)};
    for (std::string line; std::getline(stream, line);) {
        if (line.starts_with('#')) continue;
        const std::vector<std::string> cells = split(line, '\t');
        if (cells.size() != 3) continue;
        tasks.insert(cells[0]);
        if (cells[0] == task) add(table, number_of<std::int32_t>(cells[1]), cells[2], {});
    }
    if (!table.empty()) return table;
    std::string near;
    for (const std::string& name : nearest_names(task, {tasks.begin(), tasks.end()}))
        near += (near.empty() ? "" : ", ") + name;
    throw InvalidInput({"totalsegmentator:" + std::string(task), "no such version and task",
                        "version/task, as v2/total", "nearest: " + near});
}

}  // namespace palpate::imaging
