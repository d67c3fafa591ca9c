// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/case_builder/case_file.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <fmt/format.h>
#include <set>

#include "formats/model/colour.hpp"
#include "formats/model/compliance.hpp"
#include "formats/model/errors.hpp"
#include "formats/model/reading/utf8.hpp"
#include "formats/records/haptic_settings.hpp"
#include "formats/records/posture.hpp"
#include "formats/records/quality_contract.hpp"
#include "formats/toml_file/table_reader.hpp"
#include "tools/case_builder/kept_case.hpp"
#include "tools/case_builder/toml_document.hpp"
#include "tools/imaging/recipes/recipe.hpp"
#include "tools/tissue/tissue.hpp"

namespace palpate::case_builder {
namespace {

using toml_file::TableReader;

// Sets a number, a text or a flag of a request if the table has the key.
template <typename T>
void read(TableReader& table, const std::string& key, T& value) {
    if (const auto found = table.optional<T>(key)) value = *found;
}

// Texts are names and paths all, and what is not seen makes one look like another.
void refuse_unprintable(const TableReader& root, const toml::node& node, const std::string& key) {
    if (const toml::table* table = node.as_table())
        for (const auto& [inner, value] : *table) refuse_unprintable(root, value, std::string(inner.str()));
    if (const toml::array* array = node.as_array())
        for (const toml::node& item : *array) refuse_unprintable(root, item, key);
    if (const auto text = node.value_exact<std::string>(); text && !is_printable(*text))
        root.fail(node, key, "holds a control character or one that is not seen", "text without any");
}

// A length, 0 or more.
void read_length(TableReader& table, const std::string& key, double& value) {
    read(table, key, value);
    if (!(value >= 0)) table.fail(table.node(key), key, fmt::format("is {}", value), "0 or more");
}

// The rules under `key`, { touching = "skull" } or { sphere_mm = [x, y, z, r] } ...
std::vector<stages::NodePick> node_picks(TableReader& body, const std::string& key) {
    std::vector<stages::NodePick> picks;
    for (TableReader table : body.tables(key)) {
        stages::NodePick pick;
        read(table, "touching", pick.touching);
        read(table, "region", pick.region);
        pick.box_mm = table.optional_numbers("box_mm", 6).value_or(std::vector<double>{});
        pick.sphere_mm = table.optional_numbers("sphere_mm", 4).value_or(std::vector<double>{});
        pick.plane_mm = table.optional_numbers("plane_mm", 6).value_or(std::vector<double>{});
        pick.facing = table.optional_numbers("facing", 3).value_or(std::vector<double>{});
        pick.nodes_file = table.path("nodes_file").value_or("");
        table.refuse_unknown();
        if (table.raw().size() != 1)
            body.fail(table.raw(), key, "has a rule that is not understood",
                      "one of { touching = \"label\" }, { region = \"name\" }, { box_mm = [6] }, { sphere_mm "
                      "= [4] }, "
                      "{ plane_mm = [6] }, { facing = [3] }, { nodes_file = \"nodes.txt\" }");
        picks.push_back(std::move(pick));
    }
    return picks;
}

// How the compliance is computed and stored.
void read_compliance(TableReader& body, stages::CondenseRequest& request) {
    request.element = body.choice("element", {"linear", "quadratic"}).value_or(request.element);
    TableReader compliance = body.table("compliance");
    request.accuracy = compliance.positive("accuracy").value_or(request.accuracy);
    constexpr double finest = stages::CondenseRequest::finest_accuracy,
                     coarsest = HierarchicalCompliance::coarsest_accuracy;
    if (request.accuracy < finest || request.accuracy > coarsest)
        compliance.fail(compliance.node("accuracy"), "accuracy", fmt::format("is {}", request.accuracy),
                        fmt::format("{} to {}", finest, coarsest));
    request.size_mib = compliance.positive("size_mib").value_or(request.size_mib);
    request.memory_gib = compliance.positive("memory_gib").value_or(request.memory_gib);
    request.representation = compliance.choice("representation", {"auto", "dense", "hierarchical"})
                                 .value_or(request.representation);
    compliance.refuse_unknown();
}

nlohmann::ordered_json to_json(const toml::node& node) {
    if (const auto text = node.value_exact<std::string>()) return *text;
    if (const auto flag = node.value_exact<bool>()) return *flag;
    if (const auto integer = node.value_exact<std::int64_t>()) return *integer;
    if (const auto number = node.value_exact<double>()) return *number;
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    if (const toml::array* array = node.as_array())
        for (const toml::node& item : *array) list.push_back(to_json(item));
    return list;
}

// A structure's other keys are the recipe's parameters, cleaning steps in the order written; `palpate
// segment` knows which exist and refuses the rest.
StructureSpec structure(TableReader reader) {
    StructureSpec spec;
    spec.name = reader.required<std::string>("name");
    spec.recipe = reader.required<std::string>("recipe");
    for (const std::string& key : keys_as_written(reader.raw()))
        if (imaging::is_file_parameter(key))
            spec.files[key] = *reader.path(key);
        else if (key != "name" && key != "recipe")
            spec.parameters[key] = to_json(*reader.raw().get(key));
    return spec;
}

// Bodies name files and stages.
std::string body_name(TableReader& reader) {
    const std::string name = reader.required<std::string>("name");
    constexpr std::size_t longest = 200;  // of the 255 bytes of a file name
    const bool fit = !name.empty() && name.size() <= longest &&
                     std::ranges::all_of(
                         name, [](unsigned char c) { return std::isalnum(c) != 0 || c == '_' || c == '-'; });
    if (!fit)
        reader.fail(reader.node("name"), "name", "is '" + name.substr(0, longest) + "'",
                    fmt::format("letters, digits, '_' and '-', {} at most", longest));
    return name;
}

// Keys PREFIX_file, PREFIX_unit and PREFIX_frame; with a file, none of the keys that `excluded` names.
void read_imported_file(TableReader& reader, const std::string& prefix,
                        std::initializer_list<const char*> excluded, std::filesystem::path& file,
                        std::string& unit, std::string& frame) {
    const auto path = reader.path(prefix + "_file");
    read(reader, prefix + "_unit", unit);
    read(reader, prefix + "_frame", frame);
    if (!path && (reader.has(prefix + "_unit") || reader.has(prefix + "_frame")))
        reader.fail(reader.raw(), prefix + "_file", "is missing", "", "or leave out its unit and frame");
    if (!path) return;
    for (const char* key : excluded)
        if (reader.has(key))
            reader.fail(*reader.raw().get(key), key, "makes no sense beside " + prefix + "_file", "",
                        "leave one of them out");
    file = *path;
}

// colour = "#7a3a2f" of a body, or of a region of it
void read_drawn_colour(TableReader& table, const std::string& body, const std::string& region,
                       std::vector<stages::DrawnColour>& colours) {
    const auto text = table.optional<std::string>("colour");
    if (!text) return;
    const auto colour = parse_colour(*text);
    if (!colour)
        table.fail(table.node("colour"), "colour", "is '" + *text + "'",
                   "six hexadecimal digits of red, green and blue, such as \"#7a3a2f\"");
    colours.push_back({body, region, *colour});
}

RigidSpec rigid(TableReader reader) {
    RigidSpec spec;
    spec.name = body_name(reader);
    stages::SurfaceRequest& surface = spec.surface;
    read_imported_file(reader, "surface", {"label", "isovalue_hu"}, surface.surface_file, surface.unit,
                       surface.frame);
    const std::string label = reader.optional<std::string>("label").value_or(spec.name);
    if (surface.surface_file.empty()) surface.label_names = {label};
    surface.isovalue = reader.optional<double>("isovalue_hu");
    read(reader, "max_triangles", surface.max_triangles);
    read_length(reader, "max_distance_mm", surface.max_distance);
    read_drawn_colour(reader, spec.name, "", spec.colours);
    reader.refuse_unknown();
    return spec;
}

// The fields of a record that a table gives, each under key_of() and in the unit that people write.
template <typename Table, typename Record>
void read_record(TableReader& reader, const Table& table, Record& record) {
    for_each_field(table, [&](const auto& field) {
        const auto value = reader.optional<double>(key_of(field));
        if (!value) return;
        record.*field.member = *value / field.written_factor;
        if (!field.range.contains(record.*field.member))
            reader.fail(reader.node(key_of(field)), key_of(field), fmt::format("is {}", *value),
                        to_string(field.range.in_units(field.written_factor)));
    });
}

// near = "label" or [x, y, z], within_mm, cell_size_mm.
stages::NearPlace near_place(TableReader& rule) {
    stages::NearPlace place;
    if (rule.raw().get_as<toml::array>("near") != nullptr) {
        const std::vector<double> point = rule.numbers("near", 3);
        place.point = {point[0], point[1], point[2]};
    } else {
        place.label = rule.required<std::string>("near");
    }
    place.cell_size = rule.required_positive("cell_size_mm");
    place.within = rule.required_positive("within_mm");
    rule.refuse_unknown();
    return place;
}

// relaxation = [{ share, time_s }, ...]
void read_relaxation(TableReader& region, const std::string& label, stages::CondenseRequest& request) {
    std::vector<RelaxationTerm> terms;
    for (TableReader entry : region.tables("relaxation")) {
        RelaxationTerm& term = terms.emplace_back();
        for_each_field(relaxation_fields, [&](const auto& field) {
            term.*field.member = entry.required<double>(key_of(field)) / field.written_factor;
        });
        entry.refuse_unknown();
    }
    if (const auto error = relaxation_error(terms))
        region.fail(*region.raw().get("relaxation"), "relaxation", error->name + " " + error->found,
                    error->expected);
    for (const RelaxationTerm& term : terms) request.relaxation.push_back({label, term});
}

// The preset that a region names; null if it names none.
const tissue::Tissue* tissue_of(TableReader& region) {
    const auto name = region.optional<std::string>("tissue");
    if (!name) return nullptr;
    std::vector<std::string> names;
    for (const tissue::Tissue& tissue : tissue::tissues()) names.push_back(tissue.name);
    region.choice("tissue", names);
    return &tissue::require_tissue(*name, "tissue");
}

// Young's modulus, Poisson's ratio, density and relaxation: what is written, else what the tissue has.
void read_mechanics(TableReader& region, const std::string& label, DeformableSpec& spec) {
    const tissue::Tissue* const tissue = tissue_of(region);
    const auto number = [&](const char* key, double preset) {
        return tissue != nullptr ? region.optional<double>(key).value_or(preset)
                                 : region.required<double>(key);
    };
    spec.condense.materials.push_back(
        {label, number("youngs_modulus_kpa", tissue != nullptr ? tissue->youngs_modulus_kpa : 0),
         number("poissons_ratio", tissue != nullptr ? tissue->poissons_ratio : 0)});
    if (tissue != nullptr) spec.tissues.push_back({label, tissue->name});
    if (tissue != nullptr && !region.has("relaxation"))
        for (const RelaxationTerm& term : tissue->relaxation)
            spec.condense.relaxation.push_back({label, term});
    read_relaxation(region, label, spec.condense);
    if (const auto density = region.positive("density_kg_m3"))
        spec.condense.densities.push_back({label, *density});
    else if (tissue != nullptr)
        spec.condense.densities.push_back({label, tissue->density_kg_m3});
}

void read_region(TableReader& region, DeformableSpec& spec) {
    const auto label = region.required<std::string>("label");
    read_mechanics(region, label, spec);
    read_drawn_colour(region, spec.name, label, spec.colours);
    const auto cell_size = region.positive("cell_size_mm");
    const auto mesh_region = region.optional<std::int64_t>("mesh_region");
    region.refuse_unknown();
    stages::MeshRequest& mesh = spec.mesh;
    if (!mesh.mesh_file.empty()) {  // whose cells have their sizes and regions already
        if (mesh_region) mesh.region_names.push_back({static_cast<std::int32_t>(*mesh_region), label});
        return;
    }
    mesh.regions.push_back(label);
    if (cell_size) mesh.region_cell_sizes.push_back({label, *cell_size});
}

DeformableSpec deformable(TableReader reader) {
    DeformableSpec spec;
    spec.name = spec.condense.name = body_name(reader);
    stages::MeshRequest& mesh = spec.mesh;
    read_imported_file(reader, "mesh", {"mesh"}, mesh.mesh_file, mesh.unit, mesh.frame);
    TableReader sizes = reader.table("mesh");
    mesh.sizing.cell_size = sizes.positive("cell_size_mm").value_or(mesh.sizing.cell_size);
    read_length(sizes, "facet_size_mm", mesh.sizing.facet_size);
    read_length(sizes, "facet_distance_mm", mesh.sizing.facet_distance);
    read(sizes, "smoothing_mm", mesh.sizing.smoothing);
    sizes.refuse_unknown();
    for (TableReader rule : reader.tables("refine"))
        if (const stages::NearPlace place = near_place(rule); mesh.mesh_file.empty())
            mesh.near.push_back(place);
    spec.condense.fixed = node_picks(reader, "fixed");
    spec.condense.contact = node_picks(reader, "contact");
    read_compliance(reader, spec.condense);
    read_drawn_colour(reader, spec.name, "", spec.colours);
    read(reader, "large_deformation", spec.large_deformation);
    for (TableReader region : reader.tables("region")) read_region(region, spec);
    if (spec.condense.materials.empty())
        reader.fail(reader.raw(), "region", "is missing", "[[deformable.region]] with a label");
    reader.refuse_unknown();
    return spec;
}

// scanned = "supine", felt = "upright" or [x, y, z], for all bodies that give way.
void read_posture(TableReader& root, std::vector<DeformableSpec>& bodies) {
    TableReader table = root.table("posture");
    std::vector<std::string> words;
    for (const NamedPosture& named : named_postures) words.emplace_back(named.name);
    const auto posture = [&](const char* key) -> std::string {
        if (table.raw().get_as<toml::array>(key) == nullptr) return table.choice(key, words).value_or("");
        const std::vector<double> direction = table.numbers(key, 3);
        if (direction == std::vector<double>(3, 0.0))
            table.fail(table.node(key), key, "has no length", "which way gravity points, such as [0, 1, 0]");
        return fmt::format("{},{},{}", direction[0], direction[1], direction[2]);
    };
    const std::string scanned = posture("scanned"), felt = posture("felt");
    table.refuse_unknown();
    if (scanned.empty() != felt.empty())
        table.fail(table.raw(), scanned.empty() ? "scanned" : "felt", "is missing", "both postures");
    for (DeformableSpec& body : bodies) {
        if (!felt.empty() && body.condense.densities.size() != body.condense.materials.size())
            table.fail(table.raw(), "felt",
                       "needs a density of every region, and '" + body.name + "' lacks one",
                       "density_kg_m3 in each [[deformable.region]]", "soft tissue has about 1 050");
        body.condense.scanned_posture = scanned;
        body.condense.felt_posture = felt;
    }
}

void read_import_options(TableReader& input, CaseFile& result) {
    result.volume_import.series = input.text_or_number("series").value_or("");
    read(input, "accept_gaps", result.volume_import.accept_gaps);
    read(input, "deface", result.volume_import.deface);
    read(input, "scale", result.volume_import.scale);
    read(input, "offset", result.volume_import.offset);
    if (const double scale = result.volume_import.scale; !(scale > 0) || !std::isfinite(scale))
        input.fail(input.node("scale"), "scale", fmt::format("is {:g}", scale), "a number above 0",
                   "HU = scale x value + offset");
    if (const double offset = result.volume_import.offset; !std::isfinite(offset))
        input.fail(input.node("offset"), "offset", fmt::format("is {:g}", offset), "a number");
    read(input, "nifti_frame", result.volume_import.nifti_frame);
    result.labels_import.nifti_frame = result.volume_import.nifti_frame;
    if (const auto names = input.optional<std::string>("label_names")) {
        std::error_code none;  // what is too long for a path is none
        if (const auto file = input.path("label_names"); std::filesystem::is_regular_file(*file, none))
            result.label_table = file;
        result.labels_import.label_names = result.label_table ? result.label_table->string() : *names;
    }
    read(input, "overlaps", result.labels_import.overlaps);
}

}  // namespace

CaseFile read_case_file(const std::filesystem::path& path, std::span<const Override> overrides) {
    const toml::table document = read_toml(path, overrides);
    TableReader root(document, path.string(), "");
    if (const auto schema = root.required<std::int64_t>("schema"); schema != 1)
        root.fail(*document.get("schema"), "schema", "is " + std::to_string(schema), "1",
                  schema > 1 ? "use a newer palpate" : "");
    refuse_unprintable(root, document, "");
    CaseFile result;
    result.name = root.required<std::string>("name");
    if (constexpr std::size_t longest = 255; result.name.empty() || result.name.size() > longest)
        root.fail(root.node("name"), "name", fmt::format("has {} bytes", result.name.size()),
                  fmt::format("1 to {}", longest));
    TableReader input = root.table("input");
    result.volume = input.path("volume");
    result.labels = input.path("labels");
    read(input, "keep_scan", result.keep_scan);
    read_import_options(input, result);
    input.refuse_unknown();
    for (const TableReader& table : root.tables("structure")) result.structures.push_back(structure(table));
    for (const TableReader& table : root.tables("rigid")) result.rigid.push_back(rigid(table));
    for (const TableReader& table : root.tables("deformable")) result.deformable.push_back(deformable(table));
    read_posture(root, result.deformable);
    TableReader haptics = root.table("haptics"), quality = root.table("quality");
    read_record(haptics, haptic_fields, result.haptics);
    haptics.refuse_unknown();
    read_record(quality, quality_fields, result.quality);
    read(quality, "attempts", result.attempts);
    if (constexpr int most = stages::MeshRequest::most_attempts;
        result.attempts < 1 || result.attempts > most)
        quality.fail(quality.node("attempts"), "attempts", fmt::format("is {}", result.attempts),
                     fmt::format("1 to {}", most));
    quality.refuse_unknown();
    root.refuse_unknown();
    std::set<std::string> names;
    const auto require_new = [&](const std::string& name) {
        if (!names.insert(name).second)
            root.fail(document, "name", "'" + name + "' is used by two bodies", "a name of its own for each");
    };
    for (const RigidSpec& body : result.rigid) require_new(body.name);
    for (const DeformableSpec& body : result.deformable) require_new(body.name);
    if (result.rigid.empty() && result.deformable.empty())
        root.fail(document, "deformable", "is missing", "at least one [[rigid]] or [[deformable]] body");
    result.kept = kept_case(document);
    return result;
}

stages::StructureRequest structure_request(
    const StructureSpec& structure, const std::string& key_ending,
    const std::function<std::string(const std::filesystem::path&)>& file_value) {
    stages::StructureRequest request{.words = "", .name = structure.name, .recipe = structure.recipe};
    request.parameters = structure.parameters;
    for (const auto& [key, file] : structure.files) request.parameters[key + key_ending] = file_value(file);
    return request;
}

bool needs_labels(const CaseFile& case_file) {
    return !case_file.structures.empty() || std::ranges::any_of(case_file.rigid, [](const RigidSpec& body) {
        return body.surface.surface_file.empty();
    }) || std::ranges::any_of(case_file.deformable, [](const DeformableSpec& body) {
        return body.mesh.mesh_file.empty();
    });
}

bool imports_labels(const StructureSpec& structure) {
    const imaging::Recipe* recipe = imaging::find_recipe(structure.recipe);
    return recipe != nullptr && imaging::find_parameter(*recipe, "file") != nullptr &&
           !structure.files.contains("file");
}

}  // namespace palpate::case_builder
