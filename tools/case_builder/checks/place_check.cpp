// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/case_builder/checks/place_check.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "formats/model/label_map.hpp"
#include "formats/toml_file/table_reader.hpp"
#include "tools/case_builder/checks/mistakes.hpp"
#include "tools/case_builder/toml_document.hpp"
#include "tools/imaging/recipes/recipe.hpp"
#include "tools/imaging/recipes/recipe_json.hpp"
#include "tools/imaging/voxels/seed_statistics.hpp"

namespace palpate::case_builder {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;
using nlohmann::ordered_json;
using toml_file::TableReader;

constexpr const char* frame_hint =
    "places are LPS mm; 3D Slicer shows RAS, with x and y negated: 'palpate inspect' says where things lie";

std::string text_of(const Vector3d& p) {
    return fmt::format("({:.4g}, {:.4g}, {:.4g})", p.x(), p.y(), p.z());
}

std::string text_of(const AlignedBox3d& box) {
    return fmt::format("between {} and {} mm", text_of(box.min()), text_of(box.max()));
}

Vector3d point_of(const ordered_json& numbers, std::size_t first = 0) {
    return {numbers.at(first).get<double>(), numbers.at(first + 1).get<double>(),
            numbers.at(first + 2).get<double>()};
}

ImageGrid grid_of(const ordered_json& json) {
    ImageGrid grid;
    for (std::size_t axis = 0; axis < 3; ++axis) grid.size[axis] = json.at("size").at(axis);
    grid.spacing = point_of(json.at("spacing_mm"));
    grid.origin = point_of(json.at("origin_mm"));
    for (Eigen::Index column = 0; column < 3; ++column)
        grid.direction.col(column) =
            point_of(json.at("direction_columns"), 3 * static_cast<std::size_t>(column));
    return grid;
}

// Around a grid's voxels.
AlignedBox3d box_of(const ImageGrid& grid) {
    AlignedBox3d box;
    for (int corner = 0; corner < 8; ++corner) {
        Vector3d index;
        for (int axis = 0; axis < 3; ++axis)
            index[axis] = (corner >> axis & 1) != 0 ? grid.size[static_cast<std::size_t>(axis)] - 0.5 : -0.5;
        box.extend(grid.point_of(index));
    }
    return box;
}

void check_seeds(const TableReader& table, const StructureSpec& structure, const ImageGrid& grid,
                 Mistakes& mistakes) {
    for (const auto& [key, value] : structure.parameters.items()) {
        if (key.find("seeds") == std::string::npos || !value.is_array()) continue;
        const auto numbers = imaging::recipe_value(value, key);
        const auto* points = std::get_if<std::vector<double>>(&numbers);
        for (std::size_t first = 0; points != nullptr && first + 2 < points->size(); first += 3) {
            try {
                imaging::voxel_of_seed(grid, Vector3d(points->data() + first),
                                       fmt::format("structure '{}'", structure.name));
            } catch (const InvalidInput& error) {
                ErrorDetail detail = error.detail();
                detail.culprit = table.position_of(table.node(key)) + ": " + detail.culprit;
                mistakes.push_back(std::move(detail));
            }
        }
    }
}

void check_cut_box(const TableReader& table, const StructureSpec& structure, const AlignedBox3d& image,
                   Mistakes& mistakes) {
    const ordered_json& given = structure.parameters;
    if (!given.contains("box_min_mm") || !given.contains("box_max_mm")) return;
    const AlignedBox3d cut(point_of(given["box_min_mm"]), point_of(given["box_max_mm"]));
    if (!cut.intersects(image))
        mistakes.push_back(table.complaint(table.node("box_min_mm"), "box_min_mm",
                                           "begins a box that lies beside the image",
                                           "a box within " + text_of(image).substr(8), frame_hint));
}

void check_structures(TableReader& root, const CaseFile& case_file, const ImageGrid& grid,
                      Mistakes& mistakes) {
    std::size_t index = 0;
    for (const TableReader& table : root.tables("structure")) {
        const StructureSpec& structure = case_file.structures[index++];
        check_seeds(table, structure, grid, mistakes);
        check_cut_box(table, structure, box_of(grid), mistakes);
    }
}

// The box around a label's voxels and a voxel more.
AlignedBox3d box_of(const ordered_json& label) {
    const double voxels = label.at("voxels"), volume_ml = label.at("volume_ml");
    const Vector3d more = Vector3d::Constant(std::cbrt(1000 * volume_ml / voxels));
    return {point_of(label.at("box_min_mm")) - more, point_of(label.at("box_max_mm")) + more};
}

// That around all labels of a body; empty if one of them was not found.
AlignedBox3d box_of(const DeformableSpec& body, const ordered_json& found) {
    std::vector<Label> names;
    for (const ordered_json& label : found) names.push_back({label.at("value"), label.at("name")});
    AlignedBox3d box;
    for (const stages::LabelMaterial& region : body.condense.materials) {
        const auto called = find_label(names, region.label);
        if (!called) return {};
        box.extend(box_of(*std::ranges::find_if(
            found, [&](const ordered_json& label) { return label.at("value") == called->value; })));
    }
    return box;
}

// What a rule is that can pick nothing in the box; null if it may.
const char* beside(const stages::NodePick& pick, const AlignedBox3d& body) {
    const auto vector = [](const std::vector<double>& numbers, std::size_t first) {
        return Vector3d(numbers.data() + first);
    };
    if (!pick.box_mm.empty() &&
        !body.intersects(AlignedBox3d(vector(pick.box_mm, 0), vector(pick.box_mm, 3))))
        return "box_mm";
    if (!pick.sphere_mm.empty() && body.exteriorDistance(vector(pick.sphere_mm, 0)) > pick.sphere_mm[3])
        return "sphere_mm";
    if (!pick.plane_mm.empty()) {
        const Vector3d normal = vector(pick.plane_mm, 3), half = body.sizes() / 2;
        if (normal.dot(body.center() - vector(pick.plane_mm, 0)) + normal.cwiseAbs().dot(half) < 0)
            return "plane_mm";
    }
    return nullptr;
}

void check_picks(TableReader& table, const std::string& key, const std::vector<stages::NodePick>& picks,
                 const DeformableSpec& spec, const AlignedBox3d& body, Mistakes& mistakes) {
    std::size_t index = 0;
    for (const TableReader& rule : table.tables(key)) {
        const char* kind = beside(picks[index++], body);
        if (kind == nullptr) continue;
        mistakes.push_back(table.complaint(rule.raw(), key,
                                           fmt::format("has a {} that lies beside '{}'", kind, spec.name),
                                           "a place where it lies, " + text_of(body), frame_hint));
    }
}

void check_bodies(TableReader& root, const CaseFile& case_file, const ordered_json& labels,
                  Mistakes& mistakes) {
    std::size_t index = 0;
    for (TableReader& table : root.tables("deformable")) {
        const DeformableSpec& spec = case_file.deformable[index++];
        const AlignedBox3d body = box_of(spec, labels);
        if (body.isEmpty() || !spec.mesh.mesh_file.empty()) continue;
        check_picks(table, "fixed", spec.condense.fixed, spec, body, mistakes);
        check_picks(table, "contact", spec.condense.contact, spec, body, mistakes);
    }
}

}  // namespace

void check_places(const std::filesystem::path& path, const CaseFile& case_file,
                  std::span<const Override> overrides, const StageRecord& done) {
    // Of two images seeds are meant in the volume.
    const bool imported = done.name == (case_file.volume ? "import volume" : "import labels");
    if (!imported && done.name != "segment") return;
    const toml::table document = read_toml(path, overrides);
    TableReader root(document, path.string(), "");
    Mistakes mistakes;
    if (imported)
        check_structures(root, case_file, grid_of(done.result.at("grid")), mistakes);
    else
        check_bodies(root, case_file, done.result.at("labels"), mistakes);
    throw_mistakes(path, mistakes);
}

}  // namespace palpate::case_builder
