// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/stages/requests/mesh_request.hpp"

#include <charconv>
#include <cmath>
#include <fmt/format.h>

#include "tools/cli/items.hpp"
#include "tools/cli/record_options.hpp"

namespace palpate::stages {
namespace {

using Json = nlohmann::ordered_json;

std::vector<double> parse_numbers(const std::string& text) {
    std::vector<double> numbers;
    const char* at = text.c_str();
    const char* const end = at + text.size();
    while (at < end) {
        double value = 0;
        const auto [next, error] = std::from_chars(at, end, value);
        if (error != std::errc{} || !std::isfinite(value) || (next < end && *next != ',') || next + 1 == end)
            return {};
        numbers.push_back(value);
        at = next + 1;
    }
    return numbers;
}

LabelCellSize parse_label_cell_size(const std::string& text) {
    const std::size_t equals = text.rfind('=');
    const std::vector<double> size =
        equals == std::string::npos ? std::vector<double>{} : parse_numbers(text.substr(equals + 1));
    if (size.size() != 1)
        throw UsageError({"--region-cell-size", "'" + text + "'", "NAME=MM, such as tumour=4", ""});
    return {text.substr(0, equals), size[0]};
}

NearPlace parse_near_place(const std::string& text) {
    const std::size_t equals = text.rfind('=');
    const std::vector<double> sizes =
        equals == std::string::npos ? std::vector<double>{} : parse_numbers(text.substr(equals + 1));
    if (sizes.size() != 2)
        throw UsageError({"--near", "'" + text + "'",
                          "NAME=SIZE,WITHIN or X,Y,Z=SIZE,WITHIN in mm, such as tumour=3,10", ""});
    NearPlace place{.label = "", .point = {}, .within = sizes[1], .cell_size = sizes[0]};
    const std::vector<double> point = parse_numbers(text.substr(0, equals));
    if (point.size() == 3)
        place.point = {point[0], point[1], point[2]};
    else
        place.label = text.substr(0, equals);
    return place;
}

RegionNaming parse_region_naming(const std::string& text) {
    const std::size_t equals = text.find('=');
    const std::vector<double> value =
        equals == std::string::npos ? std::vector<double>{} : parse_numbers(text.substr(0, equals));
    if (value.size() != 1 || value[0] != std::floor(value[0]) || std::abs(value[0]) > 65535 ||
        equals + 1 == text.size())
        throw UsageError({"--region-name", "'" + text + "'", "VALUE=NAME, such as 4=tumour", ""});
    return {static_cast<std::int32_t>(value[0]), text.substr(equals + 1)};
}

}  // namespace

void to_json(Json& json, const LabelCellSize& size) {
    json = {{"label", size.label}, {"cell_size_mm", size.cell_size}};
}

void from_json(const Json& json, LabelCellSize& size) {
    cli::refuse_other_keys(json, {"label", "cell_size_mm"});
    size = {json.at("label"), json.at("cell_size_mm")};
}

void to_json(Json& json, const NearPlace& place) {
    json = {{"near", place.point ? Json(*place.point) : Json(place.label)},
            {"within_mm", place.within},
            {"cell_size_mm", place.cell_size}};
}

void from_json(const Json& json, NearPlace& place) {
    cli::refuse_other_keys(json, {"near", "within_mm", "cell_size_mm"});
    place = {.label = "", .point = {}, .within = json.at("within_mm"), .cell_size = json.at("cell_size_mm")};
    if (json.at("near").is_string())
        place.label = json.at("near");
    else
        place.point = json.at("near").get<std::array<double, 3>>();
}

void to_json(Json& json, const RegionNaming& naming) {
    json = {{"mesh_region", naming.mesh_region}, {"label", naming.label}};
}

void from_json(const Json& json, RegionNaming& naming) {
    cli::refuse_other_keys(json, {"mesh_region", "label"});
    naming = {json.at("mesh_region"), json.at("label")};
}

void declare(cli::Command& command, MeshRequest& request) {
    meshing::MeshSizing& sizing = request.sizing;
    command.input(
        "--labels", request.labels,
        "label map (.seg.nrrd, NIfTI, NRRD); with --mesh-file the one that the mesh is checked against");
    const cli::Option region =
        command.option("--region", request.regions, "label of the body, by name or value; repeat for more");
    const cli::Option mesh_file = command.input(
        "--mesh-file", request.mesh_file, "tetrahedra made elsewhere (.vtu, .vtk, Gmsh .msh, MEDIT .mesh)");
    command.option("--unit", request.unit, "of that file: um, mm, cm, m or in", "", "mesh_unit")
        .needs(mesh_file);
    command
        .option("--frame", request.frame, "of that file: lps or ras; empty: what it states, else lps", "",
                "mesh_frame")
        .needs(mesh_file);
    command
        .items("--region-name", cli::item_list(request.region_names, parse_region_naming),
               "VALUE=NAME: name of a region of that file; repeat for more")
        .needs(mesh_file);
    const cli::Option cell_size =
        command.option("--cell-size", sizing.cell_size, "largest tetrahedron", "mm", "cell_size_mm");
    const cli::Option region_cell_size =
        command.items("--region-cell-size", cli::item_list(request.region_cell_sizes, parse_label_cell_size),
                      "NAME=MM: another cell size for one label; otherwise no more than its radius");
    const cli::Option near = command.items(
        "--near", cli::item_list(request.near, parse_near_place),
        "NAME=SIZE,WITHIN or X,Y,Z=SIZE,WITHIN: cells of SIZE as far as WITHIN from a label or a point", "mm",
        "refine");
    const cli::Option facet_size =
        command.option("--facet-size", sizing.facet_size, "largest surface triangle; 0: as the cell size",
                       "mm", "facet_size_mm");
    const cli::Option facet_distance = command.option(
        "--facet-distance", sizing.facet_distance,
        "largest distance of triangles to the surface; 0: a tenth of the cell size, or the contract's 95th "
        "percentile if that is less",
        "mm", "facet_distance_mm");
    const cli::Option smoothing =
        command.option("--smoothing", sizing.smoothing, "Gaussian on labels; below 0: the largest voxel edge",
                       "mm", "smoothing_mm");
    const cli::Option min_component =
        command.option("--min-component-volume", sizing.min_component_volume,
                       "smaller specks and pinholes vanish", "mm³", "min_component_volume_mm3");
    for (const cli::Option option :
         {region, cell_size, region_cell_size, near, facet_size, facet_distance, smoothing, min_component})
        mesh_file.excludes(option);
    command.flag("--allow-components", request.allow_components, "accept a body of several separate pieces");
    cli::record_options(command, quality_fields, request.contract, "quality contract: ");
    command
        .option("--attempts", request.attempts,
                "meshes to make before the contract counts as missed, 1 or more")
        .range(1, MeshRequest::most_attempts);
    command.output("--preview", request.preview,
                   "picture of the mesh to write as well (.png), also where the contract is missed");
    command.output("-o,--output", request.output, "tetrahedra (.vtu), LPS mm").required();
}

}  // namespace palpate::stages
