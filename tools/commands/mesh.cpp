// SPDX-License-Identifier: GPL-3.0-or-later
#include <charconv>
#include <spdlog/spdlog.h>

#include "formats/model/errors.hpp"
#include "tools/cli/command.hpp"
#include "tools/imaging/image_files.hpp"
#include "tools/meshing/mesh_files.hpp"
#include "tools/meshing/mesh_to_contract.hpp"

using namespace palpate;
using Json = nlohmann::ordered_json;

namespace {

std::vector<double> parse_numbers(const std::string& text) {
    std::vector<double> numbers;
    const char* at = text.c_str();
    const char* const end = at + text.size();
    while (at < end) {
        double value = 0;
        const auto [next, error] = std::from_chars(at, end, value);
        if (error != std::errc{} || (next < end && *next != ',')) return {};
        numbers.push_back(value);
        at = next + 1;
    }
    return numbers;
}

// "tumour=4" names a label and its cell size in mm.
RegionSize parse_region_size(const std::string& text, const LabelMap& map, const std::string& culprit) {
    const std::size_t equals = text.rfind('=');
    const std::vector<double> size =
        equals == std::string::npos ? std::vector<double>{} : parse_numbers(text.substr(equals + 1));
    if (size.size() != 1)
        throw UsageError({"--region-cell-size", "'" + text + "'", "NAME=MM, such as tumour=4", ""});
    return {.region = require_label(map, text.substr(0, equals), culprit).value, .cell_size = size[0]};
}

// "tumour=3,10" or "12,-40,88=3,10": cells of 3 mm as far as 10 mm from a label or from a point.
NearSize parse_near(const std::string& text, const LabelMap& map, const std::string& culprit) {
    const std::size_t equals = text.rfind('=');
    const std::vector<double> sizes =
        equals == std::string::npos ? std::vector<double>{} : parse_numbers(text.substr(equals + 1));
    if (sizes.size() != 2)
        throw UsageError({"--near", "'" + text + "'",
                          "NAME=SIZE,WITHIN or X,Y,Z=SIZE,WITHIN in mm, such as tumour=3,10", ""});
    NearSize near{.points = {}, .within = sizes[1], .cell_size = sizes[0]};
    const std::vector<double> point = parse_numbers(text.substr(0, equals));
    if (point.size() == 3)
        near.points.emplace_back(point[0], point[1], point[2]);
    else
        near.label = require_label(map, text.substr(0, equals), culprit).value;
    return near;
}

Json to_json(const QualityContract& contract) {
    return {{"min_dihedral_deg", contract.min_dihedral_deg},
            {"max_dihedral_deg", contract.max_dihedral_deg},
            {"max_volume_error_percent", contract.max_volume_error_percent},
            {"max_mean_distance_mm", contract.max_mean_distance},
            {"max_p95_distance_mm", contract.max_p95_distance},
            {"max_distance_voxel_diagonals", contract.max_distance_voxels},
            {"min_dice", contract.min_dice},
            {"min_region_dice", contract.min_region_dice},
            {"max_centroid_distance_mm", contract.max_centroid_distance}};
}

Json to_json(const TetMesh& mesh, const MeshMeasures& measures) {
    Json regions = Json::array();
    for (std::size_t k = 0; k < measures.fidelity.regions.size(); ++k) {
        const RegionFidelity& fidelity = measures.fidelity.regions[k];
        const RegionDistance& distance = measures.distances[k];
        regions.push_back(
            {{"name", mesh.region_names[k].name},
             {"value", fidelity.region},
             {"volume_mm3", measures.quality.region_volumes[k].volume},
             {"volume_error_percent", fidelity.volume_error_percent},
             {"dice", fidelity.dice},
             {"centroid_distance_mm", fidelity.centroid_distance},
             {"surface_distance_mm",
              {{"mean", distance.mean},
               {"p95", distance.percentile_95},
               {"max", distance.maximum},
               {"farthest", {distance.farthest.x(), distance.farthest.y(), distance.farthest.z()}}}}});
    }
    const MeshQuality& quality = measures.quality;
    Json worst = Json::array();
    for (const WorstTetrahedron& tet : quality.worst)
        worst.push_back({{"tetrahedron", tet.tetrahedron},
                         {"min_dihedral_deg", tet.min_dihedral_deg},
                         {"max_dihedral_deg", tet.max_dihedral_deg},
                         {"at", {tet.centroid.x(), tet.centroid.y(), tet.centroid.z()}}});
    return {
        {"nodes", mesh.rest_positions.size()},
        {"tetrahedra", mesh.tetrahedra.size()},
        {"surface_nodes", std::ranges::count_if(mesh.outside_labels, [](int label) { return label >= 0; })},
        {"components", quality.components},
        {"boundary_non_manifold_edges", quality.boundary.non_manifold_edges},
        {"inverted", quality.inverted},
        {"min_dihedral_deg", quality.min_dihedral_deg},
        {"max_dihedral_deg", quality.max_dihedral_deg},
        {"dihedral_percentiles_1_5_50_95_99_deg", quality.dihedral_percentiles_deg},
        {"dihedral_histogram_10_deg", quality.dihedral_histogram},
        {"min_radius_ratio", quality.min_radius_ratio},
        {"mean_radius_ratio", quality.mean_radius_ratio},
        {"worst", worst},
        {"dice", measures.fidelity.body.dice},
        {"centroid_distance_mm", measures.fidelity.body.centroid_distance},
        {"regions", regions}};
}

Json to_json(const std::vector<MeshAttempt>& attempts) {
    Json list = Json::array();
    for (const MeshAttempt& attempt : attempts) {
        Json missed = Json::array();
        for (const ContractMiss& miss : attempt.misses)
            missed.push_back({{"found", miss.found}, {"limit", miss.limit}});
        list.push_back({{"tetrahedra", attempt.tetrahedra}, {"misses", missed}});
    }
    return list;
}

void require_contract(const std::vector<MeshAttempt>& attempts, const std::string& culprit) {
    const std::vector<ContractMiss>& missed = attempts.back().misses;
    if (missed.empty()) return;
    std::string found;
    for (const ContractMiss& miss : missed)
        found += fmt::format("{}{} (expected {})", found.empty() ? "" : "; ", miss.found, miss.limit);
    throw QualityNotMet({culprit, found, "",
                         fmt::format("after {} meshes: choose a smaller cell size, facet distance or "
                                     "--region-cell-size, or a contract that this body can keep",
                                     attempts.size())});
}

}  // namespace

int main(int argc, char** argv) {
    cli::Command command(
        {.name = "mesh",
         .summary = "Fills labels with tetrahedra of good shape that share the nodes of their interfaces.",
         .examples =
             {"palpate mesh --labels liver.seg.nrrd --region liver --region tumour --cell-size 8 "
              "--near tumour=4,10 -o liver.vtu",
              "palpate mesh --labels head.seg.nrrd --region wall --cell-size 4 --facet-distance 0.4 -o "
              "wall.vtu --json -"},
         .notes = "Sizes are radii of circumscribed spheres; edges are about 1.2 times as long.\n"
                  "A mesh that misses the quality contract is made anew, finer where it missed, before the "
                  "command "
                  "fails with exit code 4. Limits in mm hold for voxels of up to 1 mm³ and grow with the "
                  "cube root "
                  "of larger ones.\n"
                  "Source: CGAL Mesh_3 (Jamin, Alliez, Yvinec, Boissonnat 2015)."});
    std::filesystem::path labels_path, output;
    std::vector<std::string> region_names, region_sizes, near_sizes;
    MeshSizing sizing;
    QualityContract contract;
    int attempts = 4;
    bool allow_components = false;
    command.input("--labels", labels_path, "label map (.seg.nrrd, NIfTI, NRRD)")->required();
    command.option("--region", region_names, "label of the body, by name or value; repeat for more")
        ->required();
    command.option("--cell-size", sizing.cell_size, "largest tetrahedron", "mm");
    command.option("--region-cell-size", region_sizes,
                   "NAME=MM: another cell size for one label; otherwise no more than its radius");
    command.option(
        "--near", near_sizes,
        "NAME=SIZE,WITHIN or X,Y,Z=SIZE,WITHIN: cells of SIZE as far as WITHIN from a label or a point",
        "mm");
    command.option("--facet-size", sizing.facet_size, "largest surface triangle; 0: as the cell size", "mm");
    command.option("--facet-distance", sizing.facet_distance,
                   "largest distance of triangles to the surface; 0: a tenth of the cell size", "mm");
    command.option("--smoothing", sizing.smoothing, "Gaussian on labels; below 0: the largest voxel edge",
                   "mm");
    command.option("--min-component-volume", sizing.min_component_volume,
                   "smaller specks and pinholes vanish", "mm³");
    command.flag("--allow-components", allow_components, "accept a body of several separate pieces");
    command.option("--min-dihedral-deg", contract.min_dihedral_deg,
                   "quality contract: smallest dihedral angle", "degrees");
    command.option("--max-dihedral-deg", contract.max_dihedral_deg,
                   "quality contract: largest dihedral angle", "degrees");
    command.option("--max-volume-error-percent", contract.max_volume_error_percent,
                   "quality contract: volume of a region against its voxels", "%");
    command.option("--max-mean-distance", contract.max_mean_distance,
                   "quality contract: mean distance of a region's triangles and its labels' surface", "mm");
    command.option("--max-p95-distance", contract.max_p95_distance,
                   "quality contract: 95th percentile of that distance", "mm");
    command.option("--max-distance", contract.max_distance_voxels, "quality contract: largest such distance",
                   "voxel diagonals");
    command.option("--min-dice", contract.min_dice,
                   "quality contract: overlap of the re-voxelised body and its labels, 0 to 1");
    command.option("--min-region-dice", contract.min_region_dice,
                   "quality contract: overlap of each re-voxelised region and its label, 0 to 1");
    command.option("--max-centroid-distance", contract.max_centroid_distance,
                   "quality contract: distance of the centroids of body and labels", "mm");
    command.option("--attempts", attempts, "meshes to make before the contract counts as missed, 1 or more");
    command.output("-o,--output", output, "tetrahedra (.vtu), LPS mm")->required();

    return command.run(argc, argv, [&](cli::Session& session) {
        cli::StagedFile staged = session.stage(output);
        set_imaging_threads(session.threads);
        session.progress.step("read", 0);
        const LabelMap map = read_label_map(labels_path, [](auto text) { spdlog::info("{}", text); });
        std::vector<std::int32_t> regions;
        for (const std::string& name : region_names)
            regions.push_back(require_label(map, name, labels_path.string()).value);
        for (const std::string& text : region_sizes)
            sizing.regions.push_back(parse_region_size(text, map, labels_path.string()));
        for (const std::string& text : near_sizes)
            sizing.near.push_back(parse_near(text, map, labels_path.string()));

        const auto [mesh, measures, made] = mesh_to_contract(
            map, regions, sizing, contract, attempts,
            [&](std::string_view what, double fraction) { session.progress.step(what, fraction); });
        for (const ContractMiss& miss : made.size() > 1 ? made.front().misses : std::vector<ContractMiss>{})
            spdlog::info("made finer: {} (expected {})", miss.found, miss.limit);
        if (measures.quality.components > 1 && !allow_components)
            throw InvalidInput({labels_path.string(),
                                fmt::format("the body has {} separate pieces", measures.quality.components),
                                "1",
                                "keep the largest with 'palpate segment --keep-largest', or pass "
                                "--allow-components and hold each of them"});
        require_contract(made, output.string());
        write_tetrahedra(staged.path(), mesh);
        Json result = to_json(mesh, measures);
        result["contract"] = to_json(contract);
        result["attempts"] = to_json(made);
        staged.commit();
        return result;
    });
}
