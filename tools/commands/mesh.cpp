// SPDX-License-Identifier: GPL-3.0-or-later
#include <charconv>
#include <spdlog/spdlog.h>

#include "formats/model/errors.hpp"
#include "tools/cli/command.hpp"
#include "tools/imaging/image_files.hpp"
#include "tools/meshing/fidelity.hpp"
#include "tools/meshing/mesh_files.hpp"
#include "tools/meshing/quality.hpp"
#include "tools/meshing/surfaces.hpp"
#include "tools/meshing/tetrahedralise.hpp"

using namespace palpate;

namespace {

// "tumour=4" names a label and its cell size in mm.
RegionSize parse_region_size(const std::string& text, const LabelMap& map, const std::string& culprit) {
    const std::size_t equals = text.rfind('=');
    RegionSize size;
    const char* number = text.c_str() + (equals == std::string::npos ? text.size() : equals + 1);
    const auto [end, error] = std::from_chars(number, text.c_str() + text.size(), size.cell_size);
    if (equals == std::string::npos || error != std::errc{} || *end != '\0')
        throw UsageError({"--region-cell-size", "'" + text + "'", "NAME=MM, such as tumour=4", ""});
    size.region = require_label(map, text.substr(0, equals), culprit).value;
    return size;
}

nlohmann::json to_json(const TetMesh& mesh, const MeshQuality& quality,
                       const std::vector<RegionFidelity>& fidelity) {
    nlohmann::json regions = nlohmann::json::array();
    for (std::size_t k = 0; k < fidelity.size(); ++k)
        regions.push_back({{"name", mesh.region_names[k].name},
                           {"value", fidelity[k].region},
                           {"volume_mm3", quality.region_volumes[k].volume},
                           {"volume_error_percent", fidelity[k].volume_error_percent},
                           {"dice", fidelity[k].dice},
                           {"centroid_distance_mm", fidelity[k].centroid_distance}});
    return {
        {"nodes", mesh.rest_positions.size()},
        {"tetrahedra", mesh.tetrahedra.size()},
        {"surface_nodes", std::ranges::count_if(mesh.outside_labels, [](int label) { return label >= 0; })},
        {"components", quality.components},
        {"boundary_non_manifold_edges", quality.boundary.non_manifold_edges},
        {"min_dihedral_deg", quality.min_dihedral_deg},
        {"max_dihedral_deg", quality.max_dihedral_deg},
        {"dihedral_percentiles_1_5_50_95_99_deg", quality.dihedral_percentiles_deg},
        {"dihedral_histogram_10_deg", quality.dihedral_histogram},
        {"min_radius_ratio", quality.min_radius_ratio},
        {"mean_radius_ratio", quality.mean_radius_ratio},
        {"regions", regions}};
}

struct Contract {
    double min_dihedral_deg = 10, max_dihedral_deg = 170, max_volume_error_percent = 3, min_dice = 0;
};

void require(const Contract& contract, const TetMesh& mesh, const MeshQuality& quality,
             const std::vector<RegionFidelity>& fidelity, const std::string& culprit) {
    if (quality.min_dihedral_deg < contract.min_dihedral_deg ||
        quality.max_dihedral_deg > contract.max_dihedral_deg) {
        std::string places;
        for (const WorstTetrahedron& worst : quality.worst)
            places += fmt::format("{} {:.1f}° ... {:.1f}° at ({:.1f}, {:.1f}, {:.1f})",
                                  places.empty() ? "" : ",", worst.min_dihedral_deg, worst.max_dihedral_deg,
                                  worst.centroid.x(), worst.centroid.y(), worst.centroid.z());
        throw QualityNotMet({culprit, "dihedral angles of the flattest tetrahedra are" + places,
                             fmt::format("{}° ... {}°", contract.min_dihedral_deg, contract.max_dihedral_deg),
                             "choose a smaller cell size or facet distance, or smooth more"});
    }
    for (std::size_t k = 0; k < fidelity.size(); ++k) {
        const std::string& name = mesh.region_names[k].name;
        if (std::abs(fidelity[k].volume_error_percent) > contract.max_volume_error_percent)
            throw QualityNotMet(
                {culprit,
                 fmt::format("the volume of '{}' is off by {:.2f} %", name, fidelity[k].volume_error_percent),
                 fmt::format("at most {} %", contract.max_volume_error_percent),
                 "give it a smaller size with --region-cell-size " + name + "=MM"});
        if (fidelity[k].dice < contract.min_dice)
            throw QualityNotMet({culprit, fmt::format("Dice of '{}' is {:.4f}", name, fidelity[k].dice),
                                 fmt::format("{} or more", contract.min_dice),
                                 "choose a smaller facet distance, or smooth less"});
    }
}

}  // namespace

int main(int argc, char** argv) {
    cli::Command command(
        {.name = "mesh",
         .summary = "Fills labels with tetrahedra of good shape that share the nodes of their interfaces.",
         .examples =
             {"palpate mesh --labels liver.seg.nrrd --region liver --region tumour --cell-size 8 "
              "--region-cell-size tumour=4 -o liver.vtu",
              "palpate mesh --labels head.seg.nrrd --region wall --cell-size 4 --facet-distance 0.4 -o "
              "wall.vtu --json -"},
         .notes = "Sizes are radii of circumscribed spheres; edges are about 1.2 times as long.\n"
                  "Source: CGAL Mesh_3 (Jamin, Alliez, Yvinec, Boissonnat 2015)."});
    std::filesystem::path labels_path, output;
    std::vector<std::string> region_names, region_sizes;
    MeshSizing sizing;
    Contract contract;
    bool allow_components = false;
    command.input("--labels", labels_path, "label map (.seg.nrrd, NIfTI, NRRD)")->required();
    command.option("--region", region_names, "label of the body, by name or value; repeat for more")
        ->required();
    command.option("--cell-size", sizing.cell_size, "largest tetrahedron", "mm");
    command.option("--region-cell-size", region_sizes, "NAME=MM: another cell size for one label");
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
    command.option("--min-dice", contract.min_dice, "quality contract: overlap with the labels, 0 to 1");
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

        sizing.min_dihedral_deg =
            std::max({sizing.min_dihedral_deg, contract.min_dihedral_deg, 180 - contract.max_dihedral_deg});
        const TetMesh mesh = tetrahedralise(
            map, regions, sizing,
            [&](std::string_view what, double fraction) { session.progress.step(what, fraction); });
        const MeshQuality quality = measure(mesh);
        if (quality.components > 1 && !allow_components)
            throw InvalidInput({labels_path.string(),
                                fmt::format("the body has {} separate pieces", quality.components), "1",
                                "keep the largest with 'palpate segment --keep-largest', or pass "
                                "--allow-components and hold each of them"});
        if (quality.boundary.non_manifold_edges > 0)
            spdlog::warn(
                "the boundary touches itself at {} edges; a smaller cell size or facet distance may part it",
                quality.boundary.non_manifold_edges);
        const std::vector<RegionFidelity> fidelity = compare(mesh, map);
        require(contract, mesh, quality, fidelity, output.string());
        write_tetrahedra(staged.path(), mesh);
        session.progress.step("measure distance to the labels' surface", 0.95);
        const SurfaceDistance distance =
            surface_distance(boundary_surface(mesh).surface, label_surface(map, regions, sizing.smoothing));
        nlohmann::json result = to_json(mesh, quality, fidelity);
        result["surface_distance_mm"] = {
            {"mean", distance.mean}, {"p95", distance.percentile_95}, {"max", distance.maximum}};
        staged.commit();
        return result;
    });
}
