// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/case_builder/checks/place_check.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <fmt/format.h>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "formats/model/image_grid.hpp"
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
    return fmt::format("{} and {} mm", text_of(box.min()), text_of(box.max()));
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

// A corner of the box that a structure is cut to.
std::optional<Vector3d> corner_of(const StructureSpec& structure, const std::string& key) {
    if (!structure.parameters.contains(key)) return std::nullopt;
    const imaging::RecipeValue value = imaging::recipe_value(structure.parameters.at(key), key);
    const auto* numbers = std::get_if<std::vector<double>>(&value);
    if (numbers == nullptr || numbers->size() != 3) return std::nullopt;
    return Vector3d(numbers->data());
}

void check_cut_box(const TableReader& table, const StructureSpec& structure, const AlignedBox3d& image,
                   Mistakes& mistakes) {
    const auto low = corner_of(structure, "box_min_mm"), high = corner_of(structure, "box_max_mm");
    if (low && high && !AlignedBox3d(*low, *high).intersects(image))
        mistakes.push_back(table.complaint(table.node("box_min_mm"), "box_min_mm",
                                           "begins a box that lies beside the image",
                                           "a box that reaches between " + text_of(image), frame_hint));
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

// The box around a label's voxels.
AlignedBox3d box_of(const ordered_json& label) {
    return {point_of(label.at("box_min_mm")), point_of(label.at("box_max_mm"))};
}

// That around all labels of a body, and as much more as a mesh of them may reach: a voxel's edge and a
// cell's, mm. Empty if a label was not found.
AlignedBox3d box_of(const DeformableSpec& body, const ordered_json& found, double voxel) {
    std::vector<Label> names;
    for (const ordered_json& label : found) names.push_back({label.at("value"), label.at("name")});
    AlignedBox3d box;
    for (const stages::LabelMaterial& region : body.condense.materials) {
        const auto called = find_label(names, region.label);
        if (!called) return {};
        box.extend(box_of(*std::ranges::find_if(
            found, [&](const ordered_json& label) { return label.at("value") == called->value; })));
    }
    const Vector3d more = Vector3d::Constant(voxel + body.mesh.sizing.cell_size);
    return {box.min() - more, box.max() + more};
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
                                           "a place where it lies, between " + text_of(body), frame_hint));
    }
}

void check_bodies(TableReader& root, const CaseFile& case_file, const ordered_json& labels, double voxel,
                  Mistakes& mistakes) {
    std::size_t index = 0;
    for (TableReader& table : root.tables("deformable")) {
        const DeformableSpec& spec = case_file.deformable[index++];
        if (!spec.mesh.mesh_file.empty()) continue;
        const AlignedBox3d body = box_of(spec, labels, voxel);
        if (body.isEmpty()) continue;
        check_picks(table, "fixed", spec.condense.fixed, spec, body, mistakes);
        check_picks(table, "contact", spec.condense.contact, spec, body, mistakes);
    }
}

}  // namespace

struct PlaceCheck::Read {
    const CaseFile& case_file;
    std::filesystem::path path;
    toml::table document;
    double voxel = 0;  // mm, the longest edge of the image's
};

PlaceCheck::PlaceCheck(const std::filesystem::path& path, const CaseFile& case_file,
                       std::span<const Override> overrides)
    : read_(new Read{case_file, path, read_toml(path, overrides)}) {}

PlaceCheck::~PlaceCheck() = default;

void PlaceCheck::after(const StageRecord& done) {
    // Of two images seeds are meant in the volume.
    const bool imported = done.name == (read_->case_file.volume ? "import volume" : "import labels");
    if (!imported && done.name != "segment") return;
    TableReader root(read_->document, read_->path.string(), "");
    Mistakes mistakes;
    if (imported) {
        const ImageGrid grid = grid_of(done.result.at("grid"));
        read_->voxel = grid.spacing.maxCoeff();
        check_structures(root, read_->case_file, grid, mistakes);
    } else {
        check_bodies(root, read_->case_file, done.result.at("labels"), read_->voxel, mistakes);
    }
    throw_mistakes(read_->path, mistakes);
}

}  // namespace palpate::case_builder
