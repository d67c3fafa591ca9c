// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/case_builder/checks/case_check.hpp"

#include <algorithm>
#include <fmt/format.h>

#include "formats/model/label_map.hpp"
#include "formats/model/reading/small_file.hpp"
#include "formats/records/material.hpp"
#include "formats/toml_file/table_reader.hpp"
#include "tools/case_builder/checks/mistakes.hpp"
#include "tools/case_builder/toml_document.hpp"
#include "tools/imaging/recipes/recipe.hpp"
#include "tools/imaging/recipes/recipe_json.hpp"

namespace palpate::case_builder {
namespace {

using toml_file::TableReader;

using Kind = imaging::RecipeParameter::Kind;

std::string nearest(const std::string& name, const std::vector<std::string>& known) {
    const std::vector<std::string> names = nearest_names(name, known);
    return names.empty() ? "" : fmt::format("nearest names: '{}'", fmt::join(names, "', '"));
}

// The labels of the map that the structures become, by value.
std::vector<Label> labels_of(const CaseFile& case_file, std::size_t count) {
    std::vector<Label> labels;
    for (std::size_t i = 0; i < count; ++i)
        labels.push_back({static_cast<std::int32_t>(i + 1), case_file.structures[i].name});
    return labels;
}

std::vector<std::string> names_of(const std::vector<Label>& labels) {
    std::vector<std::string> names;
    for (const Label& label : labels) names.push_back(label.name);
    return names;
}

void require_file(const TableReader& table, const std::string& key, const std::filesystem::path& file,
                  Mistakes& mistakes) {
    if (!table.has(key)) return;
    const auto complain = [&](const std::string& found, const std::string& expected) {
        mistakes.push_back(
            table.complaint(table.node(key), key, found, expected, "looked for " + file.string()));
    };
    std::error_code none;  // what is too long for a path is none
    if (table.raw()[key].value_or(std::string()).empty())
        mistakes.push_back(table.complaint(table.node(key), key, "is empty", "the path of a file"));
    else if (!std::filesystem::exists(file, none))
        complain("names a file that is not there", "");
    else if (const std::string kind = other_kind(file); !kind.empty())
        complain(kind, "a file");
}

void require_label_of(const TableReader& table, const std::string& key, const std::string& name,
                      const std::vector<Label>& labels, Mistakes& mistakes) {
    if (find_label(labels, name)) return;
    mistakes.push_back(table.complaint(
        table.node(key), key, fmt::format("names '{}', which no structure before it makes", name), "",
        labels.empty() ? "add a [[structure]]" : nearest(name, names_of(labels))));
}

// A parameter as `palpate segment` will take it.
void check_parameter(const TableReader& table, const StructureSpec& structure, const std::string& key,
                     const imaging::RecipeValue& value, Mistakes& mistakes) {
    try {
        imaging::check_recipe({structure.name, structure.recipe, {{key, value}}});
    } catch (const InvalidInput& error) {
        ErrorDetail detail = error.detail();
        detail.culprit = table.position_of(table.node(key)) + ": " + detail.culprit;
        mistakes.push_back(std::move(detail));
    }
}

void check_parameters(const TableReader& table, const StructureSpec& structure,
                      const std::vector<Label>& before, Mistakes& mistakes) {
    const imaging::Recipe& recipe = *imaging::find_recipe(structure.recipe);
    for (const auto& [key, json] : structure.parameters.items()) {
        check_parameter(table, structure, key, imaging::recipe_value(json, key), mistakes);
        const imaging::RecipeParameter* parameter = imaging::find_parameter(recipe, key);
        if (parameter != nullptr && parameter->kind == Kind::structure && json.is_string())
            require_label_of(table, key, json.get<std::string>(), before, mistakes);
    }
    for (const auto& [key, file] : structure.files) {
        check_parameter(table, structure, key, file.string(), mistakes);
        require_file(table, key, file, mistakes);
    }
}

bool has_seeds(const StructureSpec& structure) {
    const auto& given = structure.parameters;
    return given.contains("seeds_mm") || given.contains("seeds") || structure.files.contains("seeds_file") ||
           structure.files.contains("scribbles");
}

void check_needs(const TableReader& table, const CaseFile& case_file, const StructureSpec& structure,
                 Mistakes& mistakes) {
    const imaging::Recipe& recipe = *imaging::find_recipe(structure.recipe);
    const auto lacks = [&](const std::string& what, const std::string& next_step) {
        mistakes.push_back(table.complaint(table.node("recipe"), "recipe",
                                           fmt::format("is '{}', which needs {}", recipe.name, what), "",
                                           next_step));
    };
    if (recipe.needs_volume && !case_file.volume) lacks("grey values", "set input.volume or pass --volume");
    if (recipe.needs_seeds && !has_seeds(structure))
        lacks("seeds", "set seeds_mm, or place them with 'palpate seeds' and set seeds_file");
    if (imports_labels(structure) && !case_file.labels)
        lacks("a label map", "set input.labels or pass --labels");
}

void check_structures(TableReader& root, const CaseFile& case_file, Mistakes& mistakes) {
    std::size_t index = 0;
    for (const TableReader& table : root.tables("structure")) {
        const StructureSpec& structure = case_file.structures[index];
        const std::vector<Label> before = labels_of(case_file, index++);
        if (std::ranges::find(before, structure.name, &Label::name) != before.end())
            mistakes.push_back(table.complaint(table.node("name"), "name",
                                               "is '" + structure.name + "' a second time", "",
                                               "give each structure its own name"));
        // As an asset refuses them, but before anything is meshed.
        nlohmann::ordered_json texts = structure.parameters;
        texts["name"] = structure.name;
        for (const auto& [key, text] : texts.items())
            if (text.is_string() && text.get<std::string>().find_first_of("/\\") != std::string::npos)
                mistakes.push_back(table.complaint(
                    table.node(key), key, "is '" + text.get<std::string>() + "'", "no '/' and no '\\'",
                    "rename it, in the label map that it is from as well"));
        if (imaging::find_recipe(structure.recipe) == nullptr) {
            std::vector<std::string> names;
            for (const imaging::Recipe& recipe : imaging::recipes()) names.push_back(recipe.name);
            mistakes.push_back(table.complaint(table.node("recipe"), "recipe",
                                               "is '" + structure.recipe + "', which there is none of", "",
                                               nearest(structure.recipe, names)));
            continue;
        }
        check_parameters(table, structure, before, mistakes);
        check_needs(table, case_file, structure, mistakes);
    }
}

// What is wrong about a rule for nodes; null if nothing is.
const char* flaw_of(const stages::NodePick& pick) {
    const auto& box = pick.box_mm;
    for (std::size_t axis = 0; axis < 3 && !box.empty(); ++axis)
        if (box[axis] >= box[axis + 3]) return "has a box whose first corner is not below its second";
    if (!pick.sphere_mm.empty() && !(pick.sphere_mm[3] > 0)) return "has a sphere without a radius";
    const auto& plane = pick.plane_mm;
    if (!plane.empty() && plane[3] == 0 && plane[4] == 0 && plane[5] == 0)
        return "has a plane without a normal";
    const auto& facing = pick.facing;
    if (!facing.empty() && facing[0] == 0 && facing[1] == 0 && facing[2] == 0)
        return "has a direction of no length";
    return nullptr;
}

// An imported mesh brings its own regions and neighbours, so their names are not checked.
void check_picks(TableReader& body, const std::string& key, const std::vector<stages::NodePick>& picks,
                 bool imported, const std::vector<Label>& labels, Mistakes& mistakes) {
    std::size_t index = 0;
    for (const TableReader& rule : body.tables(key)) {
        const stages::NodePick& pick = picks[index++];
        if (const char* flaw = flaw_of(pick)) mistakes.push_back(body.complaint(rule.raw(), key, flaw, ""));
        require_file(rule, "nodes_file", pick.nodes_file, mistakes);
        if (imported) continue;
        if (!pick.touching.empty() && pick.touching != "background")
            require_label_of(rule, "touching", pick.touching, labels, mistakes);
        if (!pick.region.empty()) require_label_of(rule, "region", pick.region, labels, mistakes);
    }
}

void check_materials(TableReader& body, const DeformableSpec& spec, const std::vector<Label>& labels,
                     Mistakes& mistakes) {
    std::size_t index = 0;
    for (const TableReader& region : body.tables("region")) {
        const stages::LabelMaterial& given = spec.condense.materials[index++];
        if (spec.mesh.mesh_file.empty()) require_label_of(region, "label", given.label, labels, mistakes);
        const Material material{.youngs_modulus = given.youngs_modulus_kpa * 1e-3,
                                .poissons_ratio = given.poissons_ratio};
        for_each_field(material_fields, [&](const auto& field) {
            const double value = material.*field.member;
            if (std::isfinite(value) && field.range.contains(value)) return;
            const std::string key = key_of(field);
            mistakes.push_back(region.complaint(region.node(key), key,
                                                fmt::format("is {:g}", value * field.written_factor),
                                                to_string(field.range.in_units(field.written_factor))));
        });
    }
}

void check_deformable(TableReader& root, const CaseFile& case_file, const std::vector<Label>& labels,
                      Mistakes& mistakes) {
    std::size_t index = 0;
    for (TableReader& body : root.tables("deformable")) {
        const DeformableSpec& spec = case_file.deformable[index++];
        const bool imported = !spec.mesh.mesh_file.empty();
        require_file(body, "mesh_file", spec.mesh.mesh_file, mistakes);
        check_materials(body, spec, labels, mistakes);
        if (spec.condense.fixed.empty())
            mistakes.push_back(body.complaint(body.raw(), "fixed", "is missing", "what holds the body",
                                              "such as fixed = [{ touching = \"bone\" }], or a box_mm or "
                                              "sphere_mm where it grows onto something"));
        check_picks(body, "fixed", spec.condense.fixed, imported, labels, mistakes);
        check_picks(body, "contact", spec.condense.contact, imported, labels, mistakes);
        for (const TableReader& rule : body.tables("refine"))
            if (const auto name = rule.raw()["near"].value<std::string>(); name && !imported)
                require_label_of(rule, "near", *name, labels, mistakes);
    }
}

void check_rigid(TableReader& root, const CaseFile& case_file, const std::vector<Label>& labels,
                 Mistakes& mistakes) {
    std::size_t index = 0;
    for (const TableReader& body : root.tables("rigid")) {
        const stages::SurfaceRequest& surface = case_file.rigid[index++].surface;
        require_file(body, "surface_file", surface.surface_file, mistakes);
        if (surface.surface_file.empty())
            require_label_of(body, body.has("label") ? "label" : "name", surface.label_names.front(), labels,
                             mistakes);
        if (surface.isovalue && !case_file.volume)
            mistakes.push_back(body.complaint(body.node("isovalue_hu"), "isovalue_hu", "needs grey values",
                                              "", "set input.volume or pass --volume, or leave it out"));
    }
}

// Inputs may have been given on the command line, so they are named by themselves.
void check_inputs(TableReader& root, const CaseFile& case_file, Mistakes& mistakes) {
    const TableReader input = root.table("input");
    const char* const next_step = "correct [input], or pass --volume or --labels";
    for (const auto& [key, file] : {std::pair("volume", case_file.volume), {"labels", case_file.labels}}) {
        std::error_code none;  // what is too long for a path is none
        if (!file) continue;
        const bool folder_may_be = key == std::string("volume");
        const std::string kind = other_kind(*file);
        if (input.raw()[key].value_or(std::string("given")).empty())
            mistakes.push_back(input.complaint(input.node(key), key, "is empty", "the path of an image"));
        else if (!std::filesystem::exists(*file, none))
            mistakes.push_back({file->string(), "is not there", "a volume or a label map", next_step});
        else if (!kind.empty() && !(folder_may_be && std::filesystem::is_directory(*file, none)))
            mistakes.push_back({file->string(), kind,
                                folder_may_be ? "a file or a folder of DICOM slices" : "a file", next_step});
    }
}

}  // namespace

void check_case_file(const std::filesystem::path& path, const CaseFile& case_file,
                     std::span<const Override> overrides) {
    const toml::table document = read_toml(path, overrides);
    TableReader root(document, path.string(), "");
    const std::vector<Label> labels = labels_of(case_file, case_file.structures.size());
    Mistakes mistakes;
    check_inputs(root, case_file, mistakes);
    check_structures(root, case_file, mistakes);
    check_rigid(root, case_file, labels, mistakes);
    check_deformable(root, case_file, labels, mistakes);
    throw_mistakes(path, mistakes);
}

}  // namespace palpate::case_builder
