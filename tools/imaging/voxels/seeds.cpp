// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/imaging/voxels/seeds.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "formats/model/errors.hpp"
#include "formats/model/reading/small_file.hpp"
#include "tools/imaging/files/shallow_json.hpp"
#include "tools/imaging/files/trimmed.hpp"

namespace palpate::imaging {
namespace {

using nlohmann::json;

constexpr std::uintmax_t most_bytes = 16 << 20;
constexpr const char* schema =
    "https://raw.githubusercontent.com/slicer/slicer/master/Modules/Loadable/Markups/Resources/Schema/"
    "markups-schema-v1.0.3.json#";

[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& found,
                         const std::string& expected = "", const std::string& next_step = "") {
    throw InvalidInput({path.string(), found, expected, next_step});
}

// "liver-2" and "liver" are points of one structure: Slicer numbers the points of a list as "%N-%d".
std::string without_number(const std::string& label) {
    const auto last = label.find_last_not_of("0123456789");
    const bool numbered =
        last != std::string::npos && last > 0 && last + 1 < label.size() && label[last] == '-';
    return numbered ? label.substr(0, last) : label;
}

Seed named_seed(const std::string& written, const std::string& if_unnamed, const Eigen::Vector3d& p_P) {
    if (written.empty()) return {if_unnamed, p_P};
    return {without_number(written), p_P, written};
}

std::string stem_of(const std::filesystem::path& path) {
    const std::string name = path.filename().string();
    return name.substr(0, name.find('.'));
}

Eigen::Vector3d to_lps(const std::filesystem::path& path, const std::string& system,
                       const Eigen::Vector3d& position) {
    if (!position.allFinite()) refuse(path, "holds a position that is no number");
    if (system == "LPS" || system == "1") return position;
    if (system == "RAS" || system == "0") return {-position[0], -position[1], position[2]};
    refuse(path, "has the coordinate system '" + system + "'", "LPS or RAS",
           "save the points from 3D Slicer");
}

// A text under `key`, `otherwise` where there is none.
std::string text_of(const std::filesystem::path& path, const json& object, const char* key,
                    const std::string& otherwise) {
    if (!object.contains(key)) return otherwise;
    if (!object[key].is_string())
        refuse(path, fmt::format("has the {} {}", key, object[key].dump().substr(0, 40)), "a text");
    return object[key];
}

Eigen::Vector3d position_of(const std::filesystem::path& path, const json& point, std::size_t number) {
    const json position = point.value("position", json());
    const bool sound = position.is_array() && position.size() == 3 &&
                       std::ranges::all_of(position, [](const json& value) { return value.is_number(); });
    if (!sound)
        refuse(path, fmt::format("point {} has the position {}", number, position.dump().substr(0, 40)),
               "three numbers, mm", "place the point again, or take it out");
    return {position[0].get<double>(), position[1].get<double>(), position[2].get<double>()};
}

std::vector<Seed> read_json(const std::filesystem::path& path, std::istream& stream) {
    const json document = shallow_json(stream);
    if (!document.is_object() || !document.contains("markups"))
        refuse(path, "holds no markups", "a point list of 3D Slicer (.mrk.json)");
    std::vector<Seed> seeds;
    try {
        for (const json& list : document.at("markups")) {
            const std::string system = text_of(path, list, "coordinateSystem", "LPS");
            if (list.contains("coordinateUnits") && list["coordinateUnits"] != "mm")
                refuse(path, "has coordinates in " + list["coordinateUnits"].dump(), "mm");
            const std::string name = text_of(path, list, "name", stem_of(path));
            std::size_t number = 0;
            for (const json& point : list.value("controlPoints", json::array())) {
                ++number;
                if (point.value("positionStatus", "defined") != "defined") continue;
                seeds.push_back(named_seed(text_of(path, point, "label", ""), name,
                                           to_lps(path, system, position_of(path, point, number))));
            }
        }
    } catch (const json::exception& error) {
        std::string reason = error.what();  // "[json.exception.type_error.302] type must be ..."
        if (const auto end = reason.find("] "); end != std::string::npos) reason.erase(0, end + 2);
        refuse(path, "cannot be read: " + reason, "a point list of 3D Slicer (.mrk.json)");
    }
    return seeds;
}

// Comma-separated fields; a field in double quotes may hold commas and doubled quotes.
std::vector<std::string> fields_of(const std::string& line) {
    std::vector<std::string> fields(1);
    bool quoted = false;
    for (std::size_t i = 0; i < line.size(); ++i) {
        const bool doubled = quoted && line[i] == '"' && i + 1 < line.size() && line[i + 1] == '"';
        if (doubled)
            fields.back() += line[i++];
        else if (line[i] == '"')
            quoted = !quoted;
        else if (line[i] == ',' && !quoted)
            fields.emplace_back();
        else if (line[i] != '\r')
            fields.back() += line[i];
    }
    return fields;
}

std::vector<Seed> read_fcsv(const std::filesystem::path& path, std::istream& stream) {
    constexpr std::size_t first_coordinate = 1, label_field = 11;
    const std::string key = "CoordinateSystem =", byte_order_mark = "\xef\xbb\xbf";
    std::string system = "RAS";  // Slicer's default for files that do not say
    std::vector<Seed> seeds;
    std::string line;
    for (int number = 1; std::getline(stream, line); ++number) {
        if (number == 1 && line.starts_with(byte_order_mark)) line.erase(0, byte_order_mark.size());
        if (const auto found = line.find(key); line.starts_with('#') && found != std::string::npos) {
            system = trimmed(line.substr(found + key.size()));
        }
        if (line.starts_with('#') || trimmed(line).empty()) continue;
        const std::vector<std::string> fields = fields_of(line);
        Eigen::Vector3d position;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const std::string text =
                fields.size() > first_coordinate + axis ? trimmed(fields[first_coordinate + axis]) : "";
            double& value = position[static_cast<Eigen::Index>(axis)];
            const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
            if (error != std::errc{} || end != text.data() + text.size())
                refuse(path, fmt::format("line {} has the coordinate '{}'", number, text), "id,x,y,z,...");
        }
        seeds.push_back(named_seed(fields.size() > label_field ? fields[label_field] : "", stem_of(path),
                                   to_lps(path, system, position)));
    }
    return seeds;
}

}  // namespace

std::vector<Seed> read_seeds(const std::filesystem::path& path) {
    const std::string name = path.filename().string();
    const bool fcsv = name.ends_with(".fcsv");
    if (!fcsv && !name.ends_with(".json"))
        refuse(path, "is no list of points", ".mrk.json or .fcsv of 3D Slicer");
    require_small_file(path, most_bytes);
    std::ifstream stream(path);
    if (!stream) refuse(path, "cannot be opened", "", "check the path");
    std::vector<Seed> seeds = fcsv ? read_fcsv(path, stream) : read_json(path, stream);
    if (seeds.empty()) refuse(path, "holds no point", "1 or more", "place points in the structure and save");
    return seeds;
}

void write_seeds(const std::filesystem::path& path, std::span<const Seed> seeds) {
    json points = json::array();
    for (const Seed& seed : seeds) {
        const std::string id = std::to_string(points.size() + 1);
        const bool number_like = without_number(seed.label) != seed.label;
        points.push_back({{"id", id},
                          {"label", number_like ? seed.label + "-" + id : seed.label},
                          {"description", ""},
                          {"associatedNodeID", ""},
                          {"position", {seed.p_P[0], seed.p_P[1], seed.p_P[2]}},
                          {"orientation", {-1.0, -0.0, -0.0, -0.0, -1.0, -0.0, 0.0, 0.0, 1.0}},
                          {"selected", true},
                          {"locked", false},
                          {"visibility", true},
                          {"positionStatus", "defined"}});
    }
    const json list{{"type", "Fiducial"},
                    {"coordinateSystem", "LPS"},
                    {"coordinateUnits", "mm"},
                    {"locked", false},
                    {"fixedNumberOfControlPoints", false},
                    {"labelFormat", "%N-%d"},
                    {"lastUsedControlPointNumber", seeds.size()},
                    {"controlPoints", points}};
    std::ofstream stream(path);
    stream << json{{"@schema", schema}, {"markups", json::array({list})}}.dump(2) << "\n";
    if (!stream.flush())
        throw SystemFailure({path.string(), "could not be written", "", "check free space and permissions"});
}

bool same_label(const std::string& a, const std::string& b) {
    return std::ranges::equal(
        a, b, {}, [](unsigned char c) { return std::tolower(c); },
        [](unsigned char c) { return std::tolower(c); });
}

std::vector<Seed> seeds_of(std::span<const Seed> seeds, const std::string& name, const std::string& culprit) {
    const auto matching = [&](const std::string Seed::*text) {
        std::vector<Seed> found;
        for (const Seed& seed : seeds)
            if (same_label(seed.*text, name)) found.push_back(seed);
        return found;
    };
    std::vector<Seed> found = matching(&Seed::label);
    if (found.empty()) found = matching(&Seed::written);
    std::set<std::string> labels;
    for (const Seed& seed : seeds) labels.insert(seed.label);
    if (found.empty() && labels.size() == 1) found.assign(seeds.begin(), seeds.end());
    if (found.empty())
        throw InvalidInput({culprit, fmt::format("no seed is labelled '{}'", name),
                            fmt::format("one of the labels '{}'", fmt::join(labels, "', '")),
                            "rename the points or the structure"});
    return found;
}

}  // namespace palpate::imaging
