// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>

#include "formats/model/label_map.hpp"
#include "formats/model/progress.hpp"
#include "formats/model/triangle_mesh.hpp"
#include "tools/imaging/files/image_files.hpp"
#include "tools/meshing/measures/quality.hpp"
#include "tools/meshing/measures/surface_distance.hpp"
#include "tools/stages/requests/surface_request.hpp"

namespace palpate::stages {

/// A surface and what was measured of it.
struct MadeSurface {
    TriangleMesh surface;  ///< LPS mm
    meshing::SurfaceQuality quality;
    /// How far decimation moved it, if it was decimated.
    struct Decimated {
        std::size_t triangles_before = 0;
        meshing::SurfaceDistance distance;
        std::int64_t self_intersecting_pairs = 0;
    };
    std::optional<Decimated> decimated;
};

/// Extracts the surface that a request asks for, before it is mended and decimated, from what its files hold:
/// the isosurface of `volume` near the labels, or their outline where there is none. Small pieces are left
/// out. The request's paths are read by messages only. Throws as isosurface(), label_surface() and
/// keep_large_pieces() do, and InvalidInput for an unknown label.
TriangleMesh full_surface(const SurfaceRequest& request, const LabelMap& labels,
                          std::optional<Volume> volume);

/// Reads, extracts or imports, mends and decimates a surface; writes nothing. Throws UsageError if the
/// request names no input or labels without a label map, QualityNotMet if the result is not closed, manifold
/// and facing outwards, and as what it calls.
MadeSurface make_surface(const SurfaceRequest& request, const ProgressCallback& progress,
                         const imaging::NoteSink& note);

}  // namespace palpate::stages
