// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/stages/surface.hpp"

#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>

#include "tools/cli/command.hpp"
#include "tools/meshing/files/mesh_files.hpp"

namespace {
using namespace palpate;

nlohmann::json to_json(const stages::MadeSurface& made) {
    nlohmann::json result;
    if (made.decimated) {
        const meshing::SurfaceDistance& distance = made.decimated->distance;
        const Eigen::Vector3d& p = distance.farthest;
        result["decimation"] = {{"triangles_before", made.decimated->triangles_before},
                                {"mean_distance_mm", distance.mean},
                                {"p95_distance_mm", distance.percentile_95},
                                {"max_distance_mm", distance.maximum},
                                {"max_distance_at_mm", {p.x(), p.y(), p.z()}},
                                {"self_intersecting_pairs", made.decimated->self_intersecting_pairs}};
    }
    result["triangles"] = made.surface.triangles.size();
    result["vertices"] = made.surface.vertices.size();
    result["pieces"] = made.quality.components;
    result["area_mm2"] = made.quality.area;
    result["volume_mm3"] = made.quality.volume;
    return result;
}

}  // namespace

int main(int argc, char** argv) {
    cli::Command command(
        {.name = "surface",
         .summary = "Extracts the closed triangle surface of a rigid structure.",
         .examples = {"palpate surface --volume head.nrrd --isovalue 226 --keep-largest -o skull.vtp",
                      "palpate surface --labels abdomen.seg.nrrd --label spine -o spine.vtp",
                      "palpate surface --surface-file skull.stl --unit cm --max-triangles 100000 "
                      "--max-distance 0.5 -o skull.vtp"},
         .notes =
             "With a volume the surface follows the grey isovalue, below the voxel's size; --labels then "
             "masks\n"
             "it to the named labels. With labels alone their outline is smoothed and keeps its volume. A "
             "imported\n"
             "surface (.vtp, .vtk, .stl, .obj, .ply) is made sound where that can be done, else refused."});
    stages::SurfaceRequest request;
    declare(command, request);
    return command.run(argc, argv, [&](cli::Session& session) {
        cli::StagedFile staged = session.stage(request.output);
        imaging::set_imaging_threads(session.threads);
        const stages::MadeSurface made = make_surface(
            request, [&](std::string_view what, double done) { session.progress.step(what, done); },
            [](std::string_view text) { spdlog::info("{}", text); });
        meshing::write_surface(staged.path(), made.surface);
        staged.commit();
        return to_json(made);
    });
}
