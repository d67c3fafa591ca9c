// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "tools/meshing/contract/fidelity.hpp"
#include "tools/meshing/labels/smoothed_labels.hpp"
#include "tools/meshing/measures/surface_distance.hpp"
#include "tools/meshing/measures/tet_faces.hpp"
#include "tools/meshing/surfaces/surfaces.hpp"

namespace palpate::meshing {
namespace {

std::vector<Eigen::Vector3d> samples(const TriangleMesh& surface, double apart) {
    std::vector<Eigen::Vector3d> points;
    for (const Triangle& t : surface.triangles) {
        const auto corner = [&](std::size_t c) -> const Eigen::Vector3d& { return surface.vertices[t[c]]; };
        const Eigen::Vector3d u = corner(1) - corner(0), v = corner(2) - corner(0);
        const double longest = std::max({u.norm(), v.norm(), (u - v).norm()});
        const int n = std::max(1, static_cast<int>(std::ceil(longest / apart)));
        // The centres of the n² like triangles that it splits into: equal weights are equal areas.
        for (int i = 0; i < n; ++i)
            for (int j = 0; i + j < n; ++j) {
                points.push_back(corner(0) + (i + 1.0 / 3) / n * u + (j + 1.0 / 3) / n * v);
                if (i + j + 1 < n)
                    points.push_back(corner(0) + (i + 2.0 / 3) / n * u + (j + 2.0 / 3) / n * v);
            }
    }
    return points;
}

std::vector<double> distances(const std::vector<Eigen::Vector3d>& points, const TriangleMesh& surface) {
    std::vector<SurfaceSample> samples;
    for (const Eigen::Vector3d& p : points) samples.push_back({p, 0});
    std::vector<double> result;
    for (const NearestPlace& place : nearest_places(samples, surface)) result.push_back(place.distance);
    return result;
}

// The triangles around one region; each vertex once, in their order.
TriangleMesh surface_around(const std::vector<InterfaceFace>& faces, const TetMesh& mesh,
                            std::int32_t region) {
    TriangleMesh surface;
    std::vector<std::int32_t> vertex_of(mesh.rest_positions.size(), -1);
    for (const InterfaceFace& face : faces) {
        if (face.inner != region && face.outer != region) continue;
        Triangle t = face.nodes;
        for (std::int32_t& node : t) {
            std::int32_t& vertex = vertex_of[node];
            if (vertex < 0) {
                vertex = static_cast<std::int32_t>(surface.vertices.size());
                surface.vertices.push_back(mesh.rest_positions[node]);
            }
            node = vertex;
        }
        surface.triangles.push_back(t);
    }
    return surface;
}

double mean_of(const std::vector<double>& values) {
    double sum = 0;
    for (const double value : values) sum += value;
    return sum / static_cast<double>(values.size());
}

double percentile_95(std::vector<double> values) {
    const auto rank =
        values.begin() + static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(values.size() - 1));
    std::ranges::nth_element(values, rank);
    return *rank;
}

}  // namespace

std::vector<TriangleMesh> region_surfaces(const RegionLabels& labels, const SmoothedLabels& smoothed) {
    std::vector<std::int64_t> voxels(labels.values.size() + 1, 0);
    for (const std::uint8_t region : labels.regions) ++voxels[region];
    std::vector<TriangleMesh> surfaces;
    for (std::size_t region = 1; region < voxels.size(); ++region)
        surfaces.push_back(region_surface(smoothed, static_cast<std::uint8_t>(region),
                                          static_cast<double>(voxels[region]) * labels.grid.voxel_volume()));
    return surfaces;
}

std::vector<RegionDistance> region_distances(const TetMesh& mesh, const RegionLabels& labels,
                                             std::span<const TriangleMesh> surfaces) {
    const std::vector<InterfaceFace> faces = interface_faces(mesh);
    std::vector<RegionDistance> result;
    for (std::size_t k = 0; k < labels.values.size(); ++k) {
        const TriangleMesh around = surface_around(faces, mesh, labels.values[k]);
        const TriangleMesh& labelled = surfaces[k];
        RegionDistance distance;
        distance.region = labels.values[k];
        if (around.triangles.empty()) {
            distance.mean = distance.percentile_95 = distance.maximum =
                std::numeric_limits<double>::infinity();
            result.push_back(distance);
            continue;
        }
        const auto add_side = [&](const std::vector<Eigen::Vector3d>& points, const TriangleMesh& surface) {
            const std::vector<double> side = distances(points, surface);
            const auto farthest = std::ranges::max_element(side);
            distance.mean += 0.5 * mean_of(side);
            distance.percentile_95 = std::max(distance.percentile_95, percentile_95(side));
            for (std::size_t i = 0; i < side.size(); ++i)
                if (side[i] > 0.5 * labels.grid.spacing.norm())
                    distance.far_places.push_back({points[i], side[i]});
            if (*farthest <= distance.maximum) return;
            distance.maximum = *farthest;
            distance.farthest = points[farthest - side.begin()];
        };
        add_side(labelled.vertices, around);
        add_side(samples(around, 0.5 * labels.grid.spacing.norm()), labelled);
        result.push_back(distance);
    }
    return result;
}

}  // namespace palpate::meshing
