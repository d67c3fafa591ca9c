// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/meshing/tetrahedra/surface_seeds.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <random>

namespace palpate::meshing {
namespace {

// The face between voxel `voxel` and its next neighbour along `axis`.
struct VoxelFace {
    std::size_t voxel;
    int axis;
};

std::vector<VoxelFace> faces_between_regions(const RegionLabels& labels) {
    const std::array<std::size_t, 3> stride{1, static_cast<std::size_t>(labels.grid.size[0]),
                                            labels.grid.offset(0, 0, 1)};
    std::vector<VoxelFace> faces;
    // The margin is outside, so no face leaves the grid.
    for (std::size_t v = 0; v + stride[2] < labels.regions.size(); ++v)
        for (int axis = 0; axis < 3; ++axis)
            if (labels.regions[v] != labels.regions[v + stride[axis]]) faces.push_back({v, axis});
    // Any order would do but the scan's, which would lay the seeds in rows.
    std::mt19937 random(20);
    for (std::size_t i = faces.size(); i > 1; --i) std::swap(faces[i - 1], faces[random() % i]);
    return faces;
}

// Looks along the face's axis for the place nearest to the face where the smoothed region changes.
std::optional<SurfaceSeed> project(const VoxelFace& face, const SmoothedLabels& smoothed) {
    const ImageGrid& grid = smoothed.grid();
    const std::size_t nx = static_cast<std::size_t>(grid.size[0]), slice = grid.offset(0, 0, 1);
    const std::size_t x = face.voxel % nx, y = face.voxel % slice / nx, z = face.voxel / slice;
    const Eigen::Vector3d index(static_cast<double>(x), static_cast<double>(y), static_cast<double>(z));
    const auto at = [&](double step) {
        return grid.point_of(index + step * Eigen::Vector3d::Unit(face.axis));
    };
    // Steps from the voxel's centre in voxels; the face is at 0.5.
    for (const auto& [from, to] : {std::pair(0.0, 1.0), std::pair(-1.0, 0.0), std::pair(1.0, 2.0)}) {
        double a = from, b = to;
        const std::uint8_t region_a = smoothed.region_at(at(a)), region_b = smoothed.region_at(at(b));
        if (region_a == region_b) continue;
        std::uint8_t beyond = region_b;
        for (int halving = 0; halving < 16; ++halving) {
            const double middle = 0.5 * (a + b);
            const std::uint8_t region = smoothed.region_at(at(middle));
            if (region == region_a) {
                a = middle;
            } else {
                b = middle;
                beyond = region;
            }
        }
        return SurfaceSeed{at(0.5 * (a + b)), std::min(region_a, beyond), std::max(region_a, beyond)};
    }
    return std::nullopt;
}

// Seeds by cubes of one edge length, to find those near a point.
class SeedGrid {
  public:
    explicit SeedGrid(double edge) : edge_(edge) {}

    bool has_within(const Eigen::Vector3d& p, double distance) const {
        const Eigen::Array3i low = cell_of(p.array() - distance), high = cell_of(p.array() + distance);
        for (int k = low[2]; k <= high[2]; ++k)
            for (int j = low[1]; j <= high[1]; ++j)
                for (int i = low[0]; i <= high[0]; ++i) {
                    const auto cell = cells_.find({i, j, k});
                    if (cell == cells_.end()) continue;
                    for (const Eigen::Vector3d& seed : cell->second)
                        if ((seed - p).squaredNorm() < distance * distance) return true;
                }
        return false;
    }

    void add(const Eigen::Vector3d& p) {
        const Eigen::Array3i cell = cell_of(p.array());
        cells_[{cell[0], cell[1], cell[2]}].push_back(p);
    }

  private:
    Eigen::Array3i cell_of(const Eigen::Array3d& p) const { return (p / edge_).floor().cast<int>(); }

    double edge_;
    std::map<std::array<int, 3>, std::vector<Eigen::Vector3d>> cells_;
};

}  // namespace

std::vector<SurfaceSeed> scatter_seeds(const RegionLabels& labels, const SmoothedLabels& smoothed,
                                       const SizeField& sizes) {
    const LabelComponents found = find_components(labels);
    std::vector<double> distance;
    for (const LabelComponent& component : found.components) {
        const double volume = static_cast<double>(component.voxels) * labels.grid.voxel_volume();
        // A ball takes some 25 seeds when they are 0.6 of its radius apart.
        distance.push_back(0.6 * std::cbrt(volume * 3 / (4 * std::numbers::pi)));
    }
    const std::array<std::size_t, 3> stride{1, static_cast<std::size_t>(labels.grid.size[0]),
                                            labels.grid.offset(0, 0, 1)};
    constexpr double facet_sizes_apart = 1.5;
    SeedGrid placed(facet_sizes_apart * sizes.largest_facet());
    std::vector<SurfaceSeed> seeds;
    for (const VoxelFace& face : faces_between_regions(labels)) {
        const auto component_of = [&](std::size_t voxel) {
            return static_cast<std::size_t>(found.component_of[voxel]);
        };
        const auto seed = project(face, smoothed);
        if (!seed) continue;
        const double apart = std::min(
            {distance[component_of(face.voxel)], distance[component_of(face.voxel + stride[face.axis])],
             facet_sizes_apart * sizes.at(seed->position, seed->lower, seed->upper).facet});
        if (placed.has_within(seed->position, apart)) continue;
        placed.add(seed->position);
        seeds.push_back(*seed);
    }
    return seeds;
}

}  // namespace palpate::meshing
