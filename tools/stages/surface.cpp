// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/stages/surface.hpp"

#include <fmt/format.h>
#include <limits>

#include "formats/model/errors.hpp"
#include "tools/meshing/files/imported_mesh.hpp"
#include "tools/meshing/files/surface_repair.hpp"
#include "tools/meshing/surfaces/surfaces.hpp"

namespace palpate::stages {
namespace {

using namespace imaging;
using namespace meshing;

void check_inputs(const SurfaceRequest& request) {
    if (request.volume.empty() && request.labels.empty() && request.surface_file.empty())
        throw UsageError(
            {"--volume, --labels, --surface-file", "none is given", "one, or the first two", ""});
    if (request.labels.empty() != request.label_names.empty())
        throw UsageError({"--labels, --label", "one is given without the other", "both or none", ""});
}

TriangleMesh imported_surface(const SurfaceRequest& request, const NoteSink& note) {
    const TriangleMesh surface =
        read_imported_surface(request.surface_file, {.unit = request.unit, .frame = request.frame}, note);
    // Whoever made it meant its small pieces.
    return request.keep_largest ? keep_largest_piece(surface) : surface;
}

TriangleMesh extracted_surface(const SurfaceRequest& request, const ProgressCallback& progress,
                               const NoteSink& note) {
    LabelMap labels;
    if (!request.labels.empty()) labels = read_label_map(request.labels, note);
    std::optional<Volume> volume;
    if (!request.volume.empty()) volume = read_volume(request.volume, note);
    progress(volume ? "extract isosurface" : "extract label surface", 0.3);
    return full_surface(request, labels, std::move(volume));
}

void decimate_to(const SurfaceRequest& request, MadeSurface& made) {
    const std::size_t before = made.surface.triangles.size();
    constexpr double any = std::numeric_limits<double>::infinity();
    auto [coarse, distance] = decimate_within(made.surface, request.max_triangles,
                                              request.max_distance > 0 ? request.max_distance : any);
    made.surface = std::move(coarse);
    made.decimated = {before, distance, static_cast<std::int64_t>(self_intersections(made.surface).size())};
}

}  // namespace

TriangleMesh full_surface(const SurfaceRequest& request, const LabelMap& labels,
                          std::optional<Volume> volume) {
    std::vector<std::int32_t> values;
    for (const std::string& name : request.label_names)
        values.push_back(require_label(labels, name, request.labels.string()).value);
    TriangleMesh surface;
    if (volume) {
        if (!values.empty()) keep_near_labels(*volume, labels, values, request.mask_reach);
        surface = isosurface(*volume, request.isovalue.value_or(0));
    } else {
        surface = label_surface(labels, values, request.smoothing);
    }
    return request.keep_largest ? keep_largest_piece(surface)
                                : keep_large_pieces(surface, request.min_triangles);
}

MadeSurface make_surface(const SurfaceRequest& request, const ProgressCallback& progress,
                         const NoteSink& note) {
    check_inputs(request);
    progress("read", 0);
    MadeSurface made;
    made.surface = repaired_surface(request.surface_file.empty() ? extracted_surface(request, progress, note)
                                                                 : imported_surface(request, note),
                                    request.output.filename().string(), note);
    if (request.max_triangles > 0 &&
        static_cast<std::int64_t>(made.surface.triangles.size()) > request.max_triangles) {
        progress("decimate", 0.5);
        decimate_to(request, made);
    }
    made.quality = measure(made.surface);
    if (!made.quality.closed_and_oriented())
        throw QualityNotMet(
            {request.output.string(),
             fmt::format("the surface has {} open, {} non-manifold, {} misoriented edges, {} triangles "
                         "without area",
                         made.quality.open_edges, made.quality.non_manifold_edges,
                         made.quality.misoriented_edges, made.quality.degenerate_triangles),
             "0", "allow more triangles, choose another isovalue, or smooth more"});
    return made;
}

}  // namespace palpate::stages
