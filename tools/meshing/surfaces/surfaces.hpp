// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "formats/model/image_grid.hpp"
#include "formats/model/label_map.hpp"
#include "formats/model/triangle_mesh.hpp"
#include "tools/meshing/labels/smoothed_labels.hpp"
#include "tools/meshing/measures/surface_distance.hpp"

namespace palpate::meshing {

/// Extracts the surface around everything of `isovalue` or more (HU for CT), facing outwards. Beyond the
/// image everything counts as low, so the surface is closed there too; values within 1e-4 of the volume's
/// range above the isovalue count as just that far above it, so no triangle collapses onto a voxel. The
/// result is a closed manifold. Throws InvalidInput if no voxel, or none but NaN, reaches the isovalue.
/// Source: Schroeder, Maynard, Geveci 2015 (flying edges). Cost: 1 s for 350 000 triangles of 7 million
/// voxels.
TriangleMesh isosurface(const Volume& volume, double isovalue);

/// Lowers every value further than `reach` voxels (counted along axes) from the voxels of the given labels to
/// the volume's smallest value: what is not that structure, such as a table, has no surface then.
/// Throws InvalidInput if the grids differ.
void keep_near_labels(Volume& volume, const LabelMap& map, std::span<const std::int32_t> values, int reach);

/// Extracts the surface of one region of smoothed labels at the level where it encloses `volume` mm³, to 0.1
/// % or as near as four levels come. Closed and facing outwards.
TriangleMesh region_surface(const SmoothedLabels& labels, std::uint8_t region, double volume);

/// Extracts the surface of labels taken together, as SmoothedLabels smooth them by a Gaussian of `smoothing`
/// mm (below 0: the largest voxel edge): thin parts, volume and centroid are kept. Closed and facing
/// outwards. Throws InvalidInput if a label has no voxel.
TriangleMesh label_surface(const LabelMap& map, std::span<const std::int32_t> values, double smoothing = -1);

/// Keeps the pieces, connected through vertices, of `min_triangles` or more, or the one of the largest area
/// only. Throws InvalidInput if nothing is left.
TriangleMesh keep_large_pieces(const TriangleMesh& surface, std::int64_t min_triangles);
TriangleMesh keep_largest_piece(const TriangleMesh& surface);

/// Reduces a closed manifold surface to `max_triangles` or the few less that the last collapse leaves, by
/// collapsing the edges that change shape and volume least (Lindstrom, Turk 1998). It stays a closed manifold
/// of the same topology; no triangle turns over. A surface that is small enough already comes back as it is.
/// Throws InvalidInput if the surface is not a manifold. Cost: O(n log n).
TriangleMesh decimate(const TriangleMesh& surface, std::int64_t max_triangles);

/// A decimated surface and how far it is from the full one.
struct Decimation {
    TriangleMesh surface;
    SurfaceDistance distance;
};

/// Decimates as decimate() does, and measures. Where either surface is further than `max_distance` mm from
/// the other at a sample, the full surface is kept and its triangles are saved elsewhere, in up to eight
/// rounds. Throws QualityNotMet naming the distance left and its place if that does not suffice, or the
/// triangles left if `max_triangles` cannot be reached. Cost: that
/// of decimate() and surface_distance() a round.
Decimation decimate_within(const TriangleMesh& surface, std::int64_t max_triangles, double max_distance);

/// The pairs of triangles that meet elsewhere than in what they share, in ascending order; exact. Vertices at
/// one place count as one. Cost: 0.3 s for 100 000 triangles.
std::vector<std::array<std::size_t, 2>> self_intersections(const TriangleMesh& surface);

/// Any one of them. Where all triangles lie on each other, all pairs would not fit into memory.
std::optional<std::array<std::size_t, 2>> first_self_intersection(const TriangleMesh& surface);

}  // namespace palpate::meshing
