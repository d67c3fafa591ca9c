// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/inspection/image_summary.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <numbers>

#include "tools/imaging/voxels/hounsfield.hpp"
#include "tools/imaging/voxels/label_statistics.hpp"
#include "tools/inspection/text.hpp"
#include "tools/stages/image.hpp"

namespace palpate::inspection {
namespace {

using namespace imaging;
using Json = nlohmann::ordered_json;
using Lines = std::vector<std::pair<std::string, std::string>>;

// Where the voxel axes point: the patient's side nearest to each, and the angle to it.
struct Orientation {
    std::string letters;  // "LPS"
    double oblique_deg = 0;
};

Orientation orientation_of(const ImageGrid& grid) {
    constexpr std::array positive{'L', 'P', 'S'}, negative{'R', 'A', 'I'};
    Orientation found;
    for (int axis = 0; axis < 3; ++axis) {
        Eigen::Index side = 0;
        const double cosine = grid.direction.col(axis).cwiseAbs().maxCoeff(&side);
        found.letters +=
            (grid.direction(side, axis) > 0 ? positive : negative)[static_cast<std::size_t>(side)];
        found.oblique_deg =
            std::max(found.oblique_deg, std::acos(std::min(1.0, cosine)) * 180 / std::numbers::pi);
    }
    return found;
}

// The edges of the outermost voxels, mm along each axis.
Eigen::Vector3d extent_of(const ImageGrid& grid) {
    return Eigen::Array3i(grid.size.data()).cast<double>() * grid.spacing.array();
}

struct ValueUnit {
    std::string unit;  // "HU"; empty: not known
    std::string told_by;
};

ValueUnit unit_of(const Volume& volume, const std::string& modality) {
    if (modality == "CT") return {"HU", "DICOM modality CT, by each slice's slope and intercept"};
    if (!modality.empty()) return {"", "DICOM modality " + modality + ": values are not HU"};
    if (holds_air(volume)) return {"HU", "values of -500 and less, as air has"};
    if (const double offset = hounsfield_offset(volume); offset > 0)
        return {"",
                fmt::format("not HU: air and soft tissue lie as if {:g} above; segment shifts them", offset)};
    if (const auto scale = scale_by_air_and_soft_tissue(volume))
        return {"", "not HU: by its air and soft tissue, if it is a CT, " + text_of(*scale)};
    return {"", "nothing tells that they are HU"};
}

constexpr std::array percents{1, 5, 25, 50, 75, 95, 99};

// The value that the given share of all lies at or below: the one at floor(share (n - 1)) in their order.
Json percentiles(std::vector<float> values) {
    Json found;
    auto from = values.begin();
    for (const int percent : percents) {
        const auto at = values.begin() +
                        static_cast<std::ptrdiff_t>(percent / 100.0 * static_cast<double>(values.size() - 1));
        std::nth_element(from, at, values.end());
        found[fmt::format("p{}", percent)] = *at;
        from = at;
    }
    return found;
}

Json grid_json(const ImageGrid& grid) {
    const Orientation orientation = orientation_of(grid);
    const Eigen::Vector3d extent = extent_of(grid);
    Json json = stages::to_json(grid);
    json["orientation"] = orientation.letters;
    json["oblique_deg"] = orientation.oblique_deg;
    json["extent_mm"] = {extent.x(), extent.y(), extent.z()};
    return json;
}

Lines grid_lines(const ImageGrid& grid) {
    const Orientation orientation = orientation_of(grid);
    std::string axes = orientation.letters + ": voxel axes i, j, k go that way";
    if (orientation.oblique_deg > 0.05)
        axes += fmt::format(", off by up to {:.1f} degrees", orientation.oblique_deg);
    return {
        {"size", fmt::format("{} x {} x {} voxels of {:.4g} x {:.4g} x {:.4g} mm", grid.size[0], grid.size[1],
                             grid.size[2], grid.spacing[0], grid.spacing[1], grid.spacing[2])},
        {"extent", lengths(extent_of(grid)) + " mm"},
        {"orientation", axes},
        {"first voxel", place(grid.origin) + " mm, LPS"}};
}

void add_notes(Summary& summary, const std::vector<std::string>& notes) {
    summary.json["notes"] = notes;
    for (const std::string& note : notes) summary.text += "note: " + note + "\n";
}

Summary summary_of(const Volume& volume, const FoundImage& found) {
    const ValueUnit unit = unit_of(volume, found.modality);
    const auto [low, high] = std::ranges::minmax(volume.values);
    Json values = {{"stored_type", found.stored_type}, {"unit", unit.unit}, {"unit_told_by", unit.told_by}};
    values["min"] = low;
    values.update(percentiles(volume.values));
    values["max"] = high;
    Lines lines = grid_lines(volume.grid);
    lines.insert(lines.begin(), {"volume", found.told_by});
    lines.emplace_back("values",
                       fmt::format("{}, {}", found.stored_type,
                                   unit.unit.empty() ? unit.told_by : unit.unit + ": " + unit.told_by));
    std::vector<std::vector<std::string>> rows(2);
    for (const auto& [name, value] : values.items()) {
        if (!value.is_number()) continue;
        rows[0].push_back(name);
        rows[1].push_back(fmt::format("{:g}", value.get<double>()));
    }
    rows[0].insert(rows[0].begin(), "");
    rows[1].insert(rows[1].begin(), "");
    return {.form = "volume",
            .json = {{"told_by", found.told_by}, {"grid", grid_json(volume.grid)}, {"values", values}},
            .text = aligned(lines) + table(rows)};
}

Summary summary_of(const LabelMap& map, const FoundImage& found) {
    Json labels = Json::array();
    std::vector<std::vector<std::string>> rows{
        {"label", "value", "voxels", "ml", "pieces", "box from (mm, LPS)", "to", "image's edge"}};
    for (const LabelStatistics& label : label_statistics(map)) {
        labels.push_back(stages::to_json(label));
        rows.push_back({label.label.name, std::to_string(label.label.value), std::to_string(label.voxels),
                        fmt::format("{:.3f}", label.volume_ml), std::to_string(label.components),
                        place(label.box.min()), place(label.box.max()),
                        label.at_image_edge ? "touches" : "-"});
    }
    Lines lines = grid_lines(map.grid);
    lines.insert(lines.begin(), {"label map", found.told_by});
    lines.emplace_back("labels", fmt::format("{}, stored as {}", map.names.size(), found.stored_type));
    return {.form = "labels",
            .json = {{"told_by", found.told_by},
                     {"grid", grid_json(map.grid)},
                     {"stored_type", found.stored_type},
                     {"labels", labels}},
            .text = aligned(lines) + "\n" + table(rows)};
}

}  // namespace

Summary summary_of_image(const std::filesystem::path& path, ImageKind kind) {
    std::vector<std::string> notes;
    const FoundImage found = read_image(path, kind, [&](std::string_view said) { notes.emplace_back(said); });
    Summary summary = std::visit([&](const auto& image) { return summary_of(image, found); }, found.image);
    add_notes(summary, notes);
    return summary;
}

}  // namespace palpate::inspection
