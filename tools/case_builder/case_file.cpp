// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/case_builder/case_file.hpp"

#include <algorithm>
#include <cctype>
#include <fmt/format.h>
#include <set>

#include "formats/model/errors.hpp"
#include "formats/records/haptic_settings.hpp"
#include "formats/records/quality_contract.hpp"
#include "tools/case_builder/table_reader.hpp"

namespace palpate::build {
namespace {

std::string joined(const std::vector<double>& values) {
    return fmt::format("{}", fmt::join(values, ","));
}

// The rules under `key`, { touching = "skull" } or { sphere_mm = [x, y, z, r] } ..., as palpate condense
// takes them; files that they name are added to `files`.
std::vector<std::string> node_rules(TableReader& body, const std::string& key,
                                    const std::filesystem::path& folder,
                                    std::vector<std::filesystem::path>& files) {
    std::vector<std::string> rules;
    for (TableReader table : body.tables(key)) {
        std::vector<std::string> found;
        if (const auto label = table.optional<std::string>("touching")) found.push_back("touching:" + *label);
        if (const auto region = table.optional<std::string>("region")) found.push_back("region:" + *region);
        for (const auto& [shape, count] :
             std::map<std::string, std::size_t>{{"box", 6}, {"sphere", 4}, {"plane", 6}})
            if (const auto numbers = table.optional_numbers(shape + "_mm", count))
                found.push_back(shape + ":" + joined(*numbers));
        if (const auto file = table.optional<std::string>("nodes_file")) {
            files.push_back(folder / *file);
            found.push_back("nodes:" + files.back().string());
        }
        table.refuse_unknown();
        if (found.size() != 1)
            body.fail(table.raw(), key, "has a rule that is not understood",
                      "one of { touching = \"label\" }, { region = \"name\" }, { box_mm = [6] }, { sphere_mm "
                      "= [4] }, "
                      "{ plane_mm = [6] }, { nodes_file = \"nodes.txt\" }");
        rules.push_back(found.front());
    }
    return rules;
}

// How the compliance is computed and stored, as options of palpate condense.
std::vector<std::string> condense_options(TableReader& body) {
    std::vector<std::string> options;
    const auto add = [&](const std::string& option, const std::string& value) {
        options.push_back(option);
        options.push_back(value);
    };
    if (const auto element = body.choice("element", {"linear", "quadratic"})) add("--element", *element);
    TableReader compliance = body.table("compliance");
    for (const auto& [key, option] : std::map<std::string, std::string>{
             {"accuracy", "--accuracy"}, {"size_mib", "--size"}, {"memory_gib", "--memory"}})
        if (const auto value = compliance.positive(key)) add(option, fmt::format("{}", *value));
    if (const auto form = compliance.choice("representation", {"auto", "dense", "hierarchical"}))
        add("--representation", *form);
    compliance.refuse_unknown();
    return options;
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

// The keys of a table in the order in which they are written; toml++ keeps them by name.
std::vector<std::string> keys_as_written(const toml::table& table) {
    std::vector<std::pair<toml::source_position, std::string>> found;
    for (const auto& [key, node] : table) found.emplace_back(node.source().begin, key.str());
    std::ranges::sort(found);
    std::vector<std::string> keys;
    for (const auto& [position, key] : found) keys.push_back(key);
    return keys;
}

// A structure's other keys are the recipe's parameters, cleaning steps in the order written; `palpate
// segment` knows which exist and refuses the rest.
StructureSpec structure(TableReader reader, const std::filesystem::path& folder) {
    StructureSpec spec;
    spec.name = reader.required<std::string>("name");
    spec.recipe = reader.required<std::string>("recipe");
    for (const std::string& key : keys_as_written(reader.raw()))
        if (key == "file" || key == "seeds_file" || key == "scribbles")
            spec.files[key] = folder / reader.required<std::string>(key);
        else if (key != "name" && key != "recipe")
            spec.parameters[key] = to_json(*reader.raw().get(key));
    return spec;
}

// Bodies name files and stages.
std::string body_name(TableReader& reader) {
    const std::string name = reader.required<std::string>("name");
    const bool fit = !name.empty() && std::ranges::all_of(name, [](unsigned char c) {
        return std::isalnum(c) != 0 || c == '_' || c == '-';
    });
    if (!fit) reader.fail(reader.raw(), "name", "is '" + name + "'", "letters, digits, '_' and '-'");
    return name;
}

// Keys PREFIX_file, PREFIX_unit and PREFIX_frame; with a file, none of the keys that `excluded` names.
std::optional<ImportedFile> imported_file(TableReader& reader, const std::string& prefix,
                                          const std::filesystem::path& folder,
                                          std::initializer_list<const char*> excluded) {
    const auto path = reader.optional<std::string>(prefix + "_file");
    const auto unit = reader.optional<std::string>(prefix + "_unit"),
               frame = reader.optional<std::string>(prefix + "_frame");
    if (!path && (unit || frame))
        reader.fail(reader.raw(), prefix + "_file", "is missing", "", "or leave out its unit and frame");
    if (!path) return std::nullopt;
    for (const char* key : excluded)
        if (reader.has(key))
            reader.fail(*reader.raw().get(key), key, "makes no sense beside " + prefix + "_file", "",
                        "leave one of them out");
    return ImportedFile{folder / *path, unit.value_or("mm"), frame.value_or("")};
}

RigidSpec rigid(TableReader reader, const std::filesystem::path& folder) {
    RigidSpec spec;
    spec.name = body_name(reader);
    spec.file = imported_file(reader, "surface", folder, {"label", "isovalue_hu"});
    spec.label = reader.optional<std::string>("label").value_or(spec.name);
    spec.isovalue = reader.optional<double>("isovalue_hu");
    spec.max_triangles = reader.optional<std::int64_t>("max_triangles");
    spec.max_distance = reader.optional<double>("max_distance_mm");
    reader.refuse_unknown();
    return spec;
}

// Optional numbers `key` of a table, under the option names that a command knows them by.
std::map<std::string, double> options(TableReader reader,
                                      const std::map<std::string, std::string>& option_of_key) {
    std::map<std::string, double> values;
    for (const auto& [key, option] : option_of_key)
        if (const auto value = reader.optional<double>(key)) values[option] = *value;
    reader.refuse_unknown();
    return values;
}

// The options of palpate pack and mesh that set a record's fields, by their keys in a case file.
template <typename Table>
std::map<std::string, std::string> option_of_key(const Table& table) {
    std::map<std::string, std::string> options;
    for_each_field(table, [&](const auto& field) { options[key_of(field)] = option_name(field.name); });
    return options;
}

// near = "label" or [x, y, z], within_mm, cell_size_mm: as palpate mesh --near takes it.
std::string near_rule(TableReader& rule) {
    const bool point = rule.raw().get_as<toml::array>("near") != nullptr;
    const std::string place = point ? joined(rule.numbers("near", 3)) : rule.required<std::string>("near");
    const auto size = rule.required<double>("cell_size_mm"), within = rule.required<double>("within_mm");
    rule.refuse_unknown();
    return fmt::format("{}={},{}", place, size, within);
}

DeformableSpec deformable(TableReader reader, const std::filesystem::path& folder) {
    DeformableSpec spec;
    spec.name = body_name(reader);
    spec.file = imported_file(reader, "mesh", folder, {"mesh"});
    spec.sizing = options(reader.table("mesh"), {{"cell_size_mm", "--cell-size"},
                                                 {"facet_size_mm", "--facet-size"},
                                                 {"facet_distance_mm", "--facet-distance"},
                                                 {"smoothing_mm", "--smoothing"}});
    for (TableReader place : reader.tables("refine")) spec.near.push_back(near_rule(place));
    spec.fixed = node_rules(reader, "fixed", folder, spec.node_files);
    spec.contact = node_rules(reader, "contact", folder, spec.node_files);
    spec.condense_options = condense_options(reader);
    for (TableReader region : reader.tables("region")) {
        spec.regions.push_back(
            {region.required<std::string>("label"), region.required<double>("youngs_modulus_kpa"),
             region.required<double>("poissons_ratio"), region.optional<double>("cell_size_mm"),
             region.optional<std::int64_t>("mesh_region")});
        region.refuse_unknown();
    }
    if (spec.regions.empty())
        reader.fail(reader.raw(), "region", "is missing", "[[deformable.region]] with a label");
    reader.refuse_unknown();
    return spec;
}

void read_import_options(TableReader& input, const std::filesystem::path& folder, CaseFile& result) {
    const auto add = [](std::vector<std::string>& options, const std::string& option,
                        const std::string& value) {
        options.push_back(option);
        options.push_back(value);
    };
    if (const auto series = input.text_or_number("series")) add(result.volume_options, "--series", *series);
    if (input.optional<bool>("accept_gaps").value_or(false))
        result.volume_options.emplace_back("--accept-gaps");
    if (const auto frame = input.optional<std::string>("nifti_frame")) {
        add(result.volume_options, "--nifti-frame", *frame);
        add(result.labels_options, "--nifti-frame", *frame);
    }
    if (const auto names = input.optional<std::string>("label_names")) {
        if (std::filesystem::is_regular_file(folder / *names)) result.label_table = folder / *names;
        add(result.labels_options, "--label-names",
            result.label_table ? result.label_table->string() : *names);
    }
    if (const auto overlaps = input.optional<std::string>("overlaps"))
        add(result.labels_options, "--overlaps", *overlaps);
}

toml::table parse(const std::filesystem::path& path) {
    try {
        return toml::parse_file(path.string());
    } catch (const toml::parse_error& error) {
        const auto line = error.source().begin.line;
        throw InvalidInput({line > 0 ? fmt::format("{}:{}", path.string(), line) : path.string(),
                            std::string(error.description()), "", "see README, 'The case file'"});
    }
}

}  // namespace

CaseFile read_case_file(const std::filesystem::path& path) {
    const toml::table document = parse(path);
    TableReader root(document, path.string(), "");
    if (const auto schema = root.required<std::int64_t>("schema"); schema != 1)
        root.fail(*document.get("schema"), "schema", "is " + std::to_string(schema), "1",
                  schema > 1 ? "use a newer palpate" : "");
    CaseFile result;
    result.name = root.required<std::string>("name");
    const auto resolved =
        [&](const std::optional<std::string>& text) -> std::optional<std::filesystem::path> {
        if (!text) return std::nullopt;
        return path.parent_path() / *text;
    };
    TableReader input = root.table("input");
    result.volume = resolved(input.optional<std::string>("volume"));
    result.labels = resolved(input.optional<std::string>("labels"));
    read_import_options(input, path.parent_path(), result);
    input.refuse_unknown();
    for (const TableReader& table : root.tables("structure"))
        result.structures.push_back(structure(table, path.parent_path()));
    for (const TableReader& table : root.tables("rigid"))
        result.rigid.push_back(rigid(table, path.parent_path()));
    for (const TableReader& table : root.tables("deformable"))
        result.deformable.push_back(deformable(table, path.parent_path()));
    result.haptics = options(root.table("haptics"), option_of_key(haptic_fields));
    auto of_quality = option_of_key(quality_fields);
    of_quality["attempts"] = "--attempts";
    result.quality = options(root.table("quality"), of_quality);
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
    return result;
}

bool needs_labels(const CaseFile& case_file) {
    const auto made_here = [](const auto& body) { return !body.file; };
    return !case_file.structures.empty() || std::ranges::any_of(case_file.rigid, made_here) ||
           std::ranges::any_of(case_file.deformable, made_here);
}

void require_what_the_bodies_need(const CaseFile& case_file) {
    for (const RigidSpec& body : case_file.rigid)
        if (body.isovalue && !case_file.volume)
            throw InvalidInput({"rigid body '" + body.name + "'",
                                "isovalue_hu needs grey values, and no volume is named", "",
                                "set input.volume or pass --volume, or leave isovalue_hu out"});
}

}  // namespace palpate::build
