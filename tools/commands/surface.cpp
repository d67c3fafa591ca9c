// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>
#include <limits>
#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>

#include "formats/model/errors.hpp"
#include "tools/cli/command.hpp"
#include "tools/imaging/files/image_files.hpp"
#include "tools/meshing/files/imported_mesh.hpp"
#include "tools/meshing/files/mesh_files.hpp"
#include "tools/meshing/files/surface_repair.hpp"
#include "tools/meshing/measures/quality.hpp"
#include "tools/meshing/surfaces/surfaces.hpp"

using namespace palpate;

int main(int argc, char** argv) {
    cli::Command command(
        {.name = "surface",
         .summary = "Extracts the closed triangle surface of a rigid structure.",
         .examples = {"palpate surface --volume head.nrrd --isovalue 226 --keep-largest -o skull.vtp",
                      "palpate surface --labels abdomen.seg.nrrd --label kidney -o kidney.vtp",
                      "palpate surface --surface-file skull.stl --unit cm --max-triangles 100000 "
                      "--max-distance 0.5 -o skull.vtp"},
         .notes =
             "With a volume the surface follows the grey isovalue, below the voxel's size; --labels then "
             "masks\n"
             "it to the named labels. With labels alone their outline is smoothed and keeps its volume. A "
             "imported\n"
             "surface (.vtp, .vtk, .stl, .obj, .ply) is made sound where that can be done, else refused."});
    std::filesystem::path volume_path, labels_path, surface_path, output;
    ImportedMeshOptions imported;
    std::vector<std::string> names;
    double isovalue = 0, smoothing = -1, max_distance = 0;
    std::int64_t max_triangles = 0, min_triangles = 100;
    int mask_reach = 2;
    bool keep_largest = false;
    const cli::Option volume_option =
        command.input("--volume", volume_path, "grey volume (NRRD, NIfTI, MetaImage, DICOM)");
    const cli::Option level =
        command.option("--isovalue", isovalue, "surface around values from here up", "HU for CT");
    level.needs(volume_option);
    volume_option.needs(level);
    const cli::Option labels_option =
        command.input("--labels", labels_path, "label map (.seg.nrrd, NIfTI, NRRD)");
    command.option("--label", names, "label by name or value; may be repeated");
    const cli::Option file_option = command.input("--surface-file", surface_path,
                                                  "imported surface instead (.vtp, .vtk, .stl, .obj, .ply)");
    file_option.excludes(volume_option).excludes(labels_option);
    command.option("--unit", imported.unit, "of that file: um, mm, cm, m or in").needs(file_option);
    command.option("--frame", imported.frame, "of that file: lps or ras; by default what it states, else lps")
        .needs(file_option);
    command.option("--mask-reach", mask_reach, "how far beyond its labels the volume counts", "voxels");
    command.option("--smoothing", smoothing, "Gaussian on labels; below 0: the largest voxel edge", "mm");
    command.flag("--keep-largest", keep_largest, "keep the piece of largest area only");
    command.option("--min-triangles", min_triangles, "leave out pieces of fewer triangles");
    const cli::Option budget =
        command.option("--max-triangles", max_triangles, "decimate to this many; 0: do not");
    command
        .option("--max-distance", max_distance,
                "largest distance between full and decimated surface; 0: any, it is measured", "mm")
        .needs(budget);
    command.output("-o,--output", output, "triangle surface (.vtp), LPS mm").required();

    return command.run(argc, argv, [&](cli::Session& session) {
        if (volume_path.empty() && labels_path.empty() && surface_path.empty())
            throw UsageError(
                {"--volume, --labels, --surface-file", "none is given", "one, or the first two", ""});
        if (labels_path.empty() != names.empty())
            throw UsageError({"--labels, --label", "one is given without the other", "both or none", ""});
        cli::StagedFile staged = session.stage(output);
        const auto note = [](std::string_view text) { spdlog::info("{}", text); };
        set_imaging_threads(session.threads);
        session.progress.step("read", 0);
        LabelMap labels;
        std::vector<std::int32_t> values;
        if (!labels_path.empty()) labels = read_label_map(labels_path, note);
        for (const std::string& name : names)
            values.push_back(require_label(labels, name, labels_path.string()).value);

        TriangleMesh surface;
        if (!surface_path.empty()) {
            surface = read_imported_surface(surface_path, imported, note);
        } else if (volume_path.empty()) {
            session.progress.step("extract label surface", 0.3);
            surface = label_surface(labels, values, smoothing);
        } else {
            Volume volume = read_volume(volume_path, note);
            session.progress.step("extract isosurface", 0.3);
            if (!values.empty()) keep_near_labels(volume, labels, values, mask_reach);
            surface = isosurface(volume, isovalue);
        }
        if (keep_largest)
            surface = keep_largest_piece(surface);
        else if (surface_path.empty())  // whoever made an imported surface meant its small pieces
            surface = keep_large_pieces(surface, min_triangles);
        nlohmann::json result;
        surface = repaired_surface(std::move(surface), output.filename().string(), note);
        if (max_triangles > 0 && static_cast<std::int64_t>(surface.triangles.size()) > max_triangles) {
            session.progress.step("decimate", 0.5);
            const std::size_t before = surface.triangles.size();
            constexpr double any = std::numeric_limits<double>::infinity();
            auto [coarse, distance] =
                decimate_within(surface, max_triangles, max_distance > 0 ? max_distance : any);
            surface = std::move(coarse);
            const Eigen::Vector3d& p = distance.farthest;
            result["decimation"] = {{"triangles_before", before},
                                    {"mean_distance_mm", distance.mean},
                                    {"p95_distance_mm", distance.percentile_95},
                                    {"max_distance_mm", distance.maximum},
                                    {"max_distance_at_mm", {p.x(), p.y(), p.z()}},
                                    {"self_intersecting_pairs", self_intersections(surface)}};
        }
        const SurfaceQuality quality = measure(surface);
        if (!quality.closed_and_oriented())
            throw QualityNotMet(
                {output.string(),
                 fmt::format("the surface has {} open, {} non-manifold, {} misoriented edges, {} triangles "
                             "without area",
                             quality.open_edges, quality.non_manifold_edges, quality.misoriented_edges,
                             quality.degenerate_triangles),
                 "0", "allow more triangles, choose another isovalue, or smooth more"});
        write_surface(staged.path(), surface);
        staged.commit();
        result["triangles"] = surface.triangles.size();
        result["vertices"] = surface.vertices.size();
        result["pieces"] = quality.components;
        result["area_mm2"] = quality.area;
        result["volume_mm3"] = quality.volume;
        return result;
    });
}
