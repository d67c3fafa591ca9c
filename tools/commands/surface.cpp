// SPDX-License-Identifier: GPL-3.0-or-later
#include <spdlog/spdlog.h>

#include "formats/model/errors.hpp"
#include "tools/cli/command.hpp"
#include "tools/imaging/image_files.hpp"
#include "tools/meshing/mesh_files.hpp"
#include "tools/meshing/quality.hpp"
#include "tools/meshing/surfaces.hpp"

using namespace palpate;

int main(int argc, char** argv) {
    cli::Command command(
        {.name = "surface",
         .summary = "Extracts the closed triangle surface of a rigid structure.",
         .examples = {"palpate surface --volume head.nrrd --isovalue 226 --keep-largest -o skull.vtp",
                      "palpate surface --labels abdomen.seg.nrrd --label kidney -o kidney.vtp"},
         .notes =
             "With a volume the surface follows the grey isovalue, below the voxel's size; --labels then "
             "masks\n"
             "it to the named labels. With labels alone their outline is smoothed and keeps its volume."});
    std::filesystem::path volume_path, labels_path, output;
    std::vector<std::string> names;
    double isovalue = 0, smoothing = -1;
    std::int64_t max_triangles = 0, min_triangles = 100;
    int mask_reach = 2;
    bool keep_largest = false;
    auto* volume_option =
        command.input("--volume", volume_path, "grey volume (NRRD, NIfTI, MetaImage, DICOM)");
    auto* level = command.option("--isovalue", isovalue, "surface around values from here up", "HU for CT");
    level->needs(volume_option);
    volume_option->needs(level);
    command.input("--labels", labels_path, "label map (.seg.nrrd, NIfTI, NRRD)");
    command.option("--label", names, "label by name or value; may be repeated");
    command.option("--mask-reach", mask_reach, "how far beyond its labels the volume counts", "voxels");
    command.option("--smoothing", smoothing, "Gaussian on labels; below 0: the largest voxel edge", "mm");
    command.flag("--keep-largest", keep_largest, "keep the piece of largest area only");
    command.option("--min-triangles", min_triangles, "leave out pieces of fewer triangles");
    command.option("--max-triangles", max_triangles, "decimate to this many; 0: do not");
    command.output("-o,--output", output, "triangle surface (.vtp), LPS mm")->required();

    return command.run(argc, argv, [&](cli::Session& session) {
        if (volume_path.empty() && labels_path.empty())
            throw UsageError({"--volume, --labels", "neither is given", "one or both", ""});
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
        if (volume_path.empty()) {
            session.progress.step("extract label surface", 0.3);
            surface = label_surface(labels, values, smoothing);
        } else {
            Volume volume = read_volume(volume_path, note);
            session.progress.step("extract isosurface", 0.3);
            if (!values.empty()) keep_near_labels(volume, labels, values, mask_reach);
            surface = isosurface(volume, isovalue);
        }
        surface = keep_largest ? keep_largest_piece(surface) : keep_large_pieces(surface, min_triangles);
        nlohmann::json result;
        if (max_triangles > 0 && static_cast<std::int64_t>(surface.triangles.size()) > max_triangles) {
            session.progress.step("decimate", 0.5);
            const TriangleMesh fine = surface;
            surface = decimate(fine, max_triangles);
            const SurfaceDistance distance = surface_distance(fine, surface);
            result["decimation"] = {{"triangles_before", fine.triangles.size()},
                                    {"mean_distance_mm", distance.mean},
                                    {"p95_distance_mm", distance.percentile_95},
                                    {"max_distance_mm", distance.maximum}};
        }
        const SurfaceQuality quality = measure(surface);
        if (!quality.closed_and_oriented())
            throw QualityNotMet(
                {output.string(),
                 fmt::format("the surface has {} open, {} non-manifold, {} misoriented edges",
                             quality.open_edges, quality.non_manifold_edges, quality.misoriented_edges),
                 "0", "choose another isovalue, or smooth more"});
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
