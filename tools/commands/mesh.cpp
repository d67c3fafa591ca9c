// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <set>
#include <spdlog/spdlog.h>

#include "formats/model/errors.hpp"
#include "tools/cli/command.hpp"
#include "tools/cli/record_options.hpp"
#include "tools/commands/mesh/arguments.hpp"
#include "tools/commands/mesh/results.hpp"
#include "tools/imaging/files/image_files.hpp"
#include "tools/meshing/contract/mesh_to_contract.hpp"
#include "tools/meshing/files/imported_mesh.hpp"
#include "tools/meshing/files/mesh_files.hpp"

using namespace palpate;

namespace {

struct Body {
    TetMesh mesh;
    std::int64_t pieces = 0;
    std::vector<ContractCheck> checks;
    std::string next_step;  // if the contract is missed
    mesh::Json result;
};

Body make_body(ContractedMesh made) {
    if (made.attempts.size() > 1)
        for (const ContractCheck& miss : made.attempts.front().misses)
            spdlog::info("made finer: {} was {} (expected {})", miss.what, miss.found, miss.limit);
    Body body;
    body.pieces = made.measures.quality.components;
    body.checks = made.checks;
    body.next_step = fmt::format(
        "after {} meshes: choose a smaller cell size, facet distance or --region-cell-size, or a contract "
        "that this body can keep",
        made.attempts.size());
    body.result = mesh::to_json(made.mesh, made.measures);
    body.result["attempts"] = mesh::to_json(made.attempts);
    body.mesh = std::move(made.mesh);
    return body;
}

// Measures against the labels if there is one for every region.
Body take_imported(const std::filesystem::path& path, const ImportedMeshOptions& options,
                   const std::filesystem::path& labels_path, const QualityContract& contract,
                   const NoteSink& note) {
    Body body;
    body.mesh = read_imported_tetrahedra(path, options, note);
    body.next_step = "mend the mesh where it was made, or state a contract that it can keep";
    const MeshQuality quality = measure(body.mesh);
    body.pieces = quality.components;
    body.checks = check_shape(contract, body.mesh, quality);
    body.result = mesh::to_json(body.mesh, quality);
    if (labels_path.empty()) return body;

    const LabelMap map = read_label_map(labels_path, note);
    adopt_labels(body.mesh, map);
    const std::set<std::int32_t> found(body.mesh.regions.begin(), body.mesh.regions.end());
    const std::vector<std::int32_t> values(found.begin(), found.end());
    if (!std::ranges::all_of(values, [&](std::int32_t value) {
            return std::ranges::find(map.names, value, &Label::value) != map.names.end();
        })) {
        spdlog::warn("a region of the mesh has no label: the mesh is not measured against the labels");
        body.result["fidelity"] = "not measured";
        return body;
    }
    const MeshSizing defaults;
    const MeshDomain domain = prepare_domain(map, values, defaults.smoothing, defaults.min_component_volume);
    const MeshMeasures measures =
        measure(body.mesh, domain.labels, region_surfaces(domain.labels, domain.smoothed));
    const auto fidelity = check_fidelity(contract, body.mesh, measures, map.grid);
    body.checks.insert(body.checks.end(), fidelity.begin(), fidelity.end());
    body.result = mesh::to_json(body.mesh, measures);
    return body;
}

}  // namespace

int main(int argc, char** argv) {
    cli::Command command(
        {.name = "mesh",
         .summary =
             "Fills labels with tetrahedra of good shape, or checks and converts a mesh made elsewhere.",
         .examples =
             {"palpate mesh --labels liver.seg.nrrd --region liver --region tumour --cell-size 8 "
              "--near tumour=4,10 -o liver.vtu",
              "palpate mesh --labels head.seg.nrrd --region wall --cell-size 4 --facet-distance 0.4 -o "
              "wall.vtu --json -",
              "palpate mesh --mesh-file liver.msh --unit cm --region-name 1=liver -o liver.vtu"},
         .notes = "Sizes are radii of circumscribed spheres; edges are about 1.2 times as long.\n"
                  "A mesh that misses the quality contract is made anew, finer where it missed, before the "
                  "command "
                  "fails with exit code 4. Limits in mm hold for voxels of up to 1 mm³ and grow with the "
                  "cube root "
                  "of larger ones.\n"
                  "Source: CGAL Mesh_3 (Jamin, Alliez, Yvinec, Boissonnat 2015)."});
    std::filesystem::path labels_path, mesh_path, output;
    std::vector<std::string> regions, region_sizes, near_sizes, region_names;
    ImportedMeshOptions imported;
    MeshSizing sizing;
    QualityContract contract;
    int attempts = 4;
    bool allow_components = false;
    command.input(
        "--labels", labels_path,
        "label map (.seg.nrrd, NIfTI, NRRD); with --mesh-file the one that the mesh is checked against");
    const cli::Option region =
        command.option("--region", regions, "label of the body, by name or value; repeat for more");
    const cli::Option mesh_file = command.input(
        "--mesh-file", mesh_path, "tetrahedra made elsewhere (.vtu, .vtk, Gmsh .msh, MEDIT .mesh)");
    command.option("--unit", imported.unit, "of that file: um, mm, cm, m or in").needs(mesh_file);
    command.option("--frame", imported.frame, "of that file: lps or ras; empty: what it states, else lps")
        .needs(mesh_file);
    command
        .option("--region-name", region_names, "VALUE=NAME: name of a region of that file; repeat for more")
        .needs(mesh_file);
    const cli::Option cell_size =
        command.option("--cell-size", sizing.cell_size, "largest tetrahedron", "mm");
    const cli::Option region_cell_size =
        command.option("--region-cell-size", region_sizes,
                       "NAME=MM: another cell size for one label; otherwise no more than its radius");
    const cli::Option near = command.option(
        "--near", near_sizes,
        "NAME=SIZE,WITHIN or X,Y,Z=SIZE,WITHIN: cells of SIZE as far as WITHIN from a label or a point",
        "mm");
    const cli::Option facet_size = command.option("--facet-size", sizing.facet_size,
                                                  "largest surface triangle; 0: as the cell size", "mm");
    const cli::Option facet_distance = command.option(
        "--facet-distance", sizing.facet_distance,
        "largest distance of triangles to the surface; 0: a tenth of the cell size, or the contract's 95th "
        "percentile if that is less",
        "mm");
    const cli::Option smoothing = command.option("--smoothing", sizing.smoothing,
                                                 "Gaussian on labels; below 0: the largest voxel edge", "mm");
    const cli::Option min_component = command.option("--min-component-volume", sizing.min_component_volume,
                                                     "smaller specks and pinholes vanish", "mm³");
    for (const cli::Option option :
         {region, cell_size, region_cell_size, near, facet_size, facet_distance, smoothing, min_component})
        mesh_file.excludes(option);
    command.flag("--allow-components", allow_components, "accept a body of several separate pieces");
    cli::record_options(command, quality_fields, contract, "quality contract: ");
    command.option("--attempts", attempts, "meshes to make before the contract counts as missed, 1 or more")
        .range(1, 100);
    command.output("-o,--output", output, "tetrahedra (.vtu), LPS mm").required();

    return command.run(argc, argv, [&](cli::Session& session) {
        cli::StagedFile staged = session.stage(output);
        const auto progress = [&](std::string_view what, double fraction) {
            session.progress.step(what, fraction);
        };
        const auto note = [](std::string_view text) { spdlog::info("{}", text); };
        set_imaging_threads(session.threads);
        progress("read", 0);
        Body body;
        if (!mesh_path.empty()) {
            imported.region_names = mesh::parse_region_names(region_names);
            body = take_imported(mesh_path, imported, labels_path, contract, note);
        } else {
            if (labels_path.empty() || regions.empty())
                throw UsageError({"mesh", "nothing to mesh", "--labels with --region, or --mesh-file", ""});
            const LabelMap map = read_label_map(labels_path, note);
            std::vector<std::int32_t> values;
            for (const std::string& name : regions)
                values.push_back(require_label(map, name, labels_path.string()).value);
            for (const std::string& text : region_sizes)
                sizing.regions.push_back(mesh::parse_region_size(text, map, values, labels_path.string()));
            for (const std::string& text : near_sizes)
                sizing.near.push_back(mesh::parse_near(text, map, labels_path.string()));
            body = make_body(mesh_to_contract(map, values, sizing, contract, attempts, progress));
        }
        if (body.pieces > 1 && !allow_components)
            throw InvalidInput({(mesh_path.empty() ? labels_path : mesh_path).string(),
                                fmt::format("the body has {} separate pieces", body.pieces), "1",
                                "keep the largest with 'palpate segment --keep-largest', or pass "
                                "--allow-components and hold each of them"});
        mesh::require_kept(body.checks, output.string(), body.next_step);
        write_tetrahedra(staged.path(), body.mesh);
        body.result["checks"] = mesh::to_json(body.checks);
        staged.commit();
        return body.result;
    });
}
