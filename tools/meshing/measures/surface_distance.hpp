// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "formats/model/triangle_mesh.hpp"

namespace palpate::meshing {

/// A place on a surface where its distance to another one is measured.
struct SurfaceSample {
    Eigen::Vector3d point = Eigen::Vector3d::Zero();  ///< p_P, mm
    std::int32_t triangle = 0;                        ///< that it lies on
    std::int32_t vertex = -1;                         ///< that it is, -1: within an edge or a triangle
};

/// Lists every vertex in use, the middle of every edge of a closed surface and every triangle's centroid.
std::vector<SurfaceSample> samples_of(const TriangleMesh& surface);

/// The nearest place of a surface.
struct NearestPlace {
    double distance = 0;        ///< mm
    std::int32_t triangle = 0;  ///< that it lies on
};

/// Finds the nearest place of `surface` for each sample. Cost: O(log n) a sample.
std::vector<NearestPlace> nearest_places(std::span<const SurfaceSample> samples, const TriangleMesh& surface);

/// How far two surfaces are apart, mm, both ways over the samples of each.
struct SurfaceDistance {
    double mean = 0, percentile_95 = 0, maximum = 0;
    Eigen::Vector3d farthest = Eigen::Vector3d::Zero();  ///< p_P of the sample at `maximum`
};

/// Sums up distances measured both ways: `of_a` says what is nearest to `samples_a`, and so on.
SurfaceDistance summary(std::span<const SurfaceSample> samples_a, std::span<const NearestPlace> of_a,
                        std::span<const SurfaceSample> samples_b, std::span<const NearestPlace> of_b);

/// How far two surfaces are apart, and which triangles of the first one.
struct TriangleDistances {
    SurfaceDistance whole;            ///< both ways
    std::vector<double> of_triangle;  ///< of the first surface: the largest of its corners and samples, mm
};

/// Measures the distance of two surfaces both ways. Searches nothing where they are one and the same, else
/// cost: O((m + n) log(m + n)).
TriangleDistances triangle_distances(const TriangleMesh& surface, const TriangleMesh& reference);

/// The same without the triangles.
SurfaceDistance surface_distance(const TriangleMesh& a, const TriangleMesh& b);

}  // namespace palpate::meshing
