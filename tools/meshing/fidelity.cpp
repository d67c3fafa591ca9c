// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/meshing/fidelity.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "formats/model/errors.hpp"

namespace palpate {
namespace {

void paint(const Eigen::Matrix<double, 3, 4>& corners, std::int32_t region, const ImageGrid& grid,
           std::vector<std::int32_t>& voxels) {
    std::array<std::int32_t, 3> low{}, high{};
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
        const auto a = static_cast<std::size_t>(axis);
        low[a] = std::max(0, static_cast<std::int32_t>(std::ceil(corners.row(axis).minCoeff())));
        high[a] =
            std::min(grid.size[a] - 1, static_cast<std::int32_t>(std::floor(corners.row(axis).maxCoeff())));
    }
    // Barycentric coordinates are affine in the index: weights = slope * index + start.
    Eigen::Matrix4d system;
    system << corners, Eigen::RowVector4d::Ones();
    const Eigen::Matrix4d inverse = system.inverse();
    for (std::int32_t k = low[2]; k <= high[2]; ++k)
        for (std::int32_t j = low[1]; j <= high[1]; ++j) {
            const Eigen::Vector4d start = inverse.col(1) * j + inverse.col(2) * k + inverse.col(3);
            std::int32_t* row = voxels.data() + grid.offset(0, j, k);
            for (std::int32_t i = low[0]; i <= high[0]; ++i)
                if ((start + inverse.col(0) * i).minCoeff() >= 0) row[i] = region;
        }
}

// Voxel counts and index sums of a label, of a region's paint, and of both at once.
struct Overlap {
    std::int64_t label = 0, painted = 0, both = 0;
    Eigen::Vector3d label_sum = Eigen::Vector3d::Zero(), painted_sum = Eigen::Vector3d::Zero();
};

}  // namespace

std::vector<std::int32_t> voxelise(const TetMesh& mesh, const ImageGrid& grid) {
    std::vector<std::int32_t> voxels(grid.voxel_count(), 0);
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
        Eigen::Matrix<double, 3, 4> corners;
        for (std::size_t c = 0; c < 4; ++c)
            corners.col(static_cast<Eigen::Index>(c)) =
                grid.index_of(mesh.rest_positions[static_cast<std::size_t>(mesh.tetrahedra[t][c])]);
        paint(corners, mesh.regions[t], grid, voxels);
    }
    return voxels;
}

std::vector<RegionFidelity> compare(const TetMesh& mesh, const LabelMap& map) {
    std::map<std::int32_t, Overlap> overlaps;
    std::map<std::int32_t, double> volumes;
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
        volumes[mesh.regions[t]] += six_volume(mesh, t) / 6;
    std::vector<Overlap*> overlap_of(65536, nullptr);
    for (const auto& [region, volume] : volumes)
        overlap_of.at(static_cast<std::size_t>(region)) = &overlaps[region];

    const std::vector<std::int32_t> painted = voxelise(mesh, map.grid);
    std::size_t offset = 0;
    for (std::int32_t k = 0; k < map.grid.size[2]; ++k)
        for (std::int32_t j = 0; j < map.grid.size[1]; ++j)
            for (std::int32_t i = 0; i < map.grid.size[0]; ++i, ++offset) {
                const Eigen::Vector3d index(i, j, k);
                if (Overlap* overlap = overlap_of[map.labels[offset]]) {
                    ++overlap->label;
                    overlap->label_sum += index;
                    overlap->both += painted[offset] == map.labels[offset];
                }
                if (painted[offset] > 0) {
                    Overlap* overlap = overlap_of[static_cast<std::size_t>(painted[offset])];
                    ++overlap->painted;
                    overlap->painted_sum += index;
                }
            }

    std::vector<RegionFidelity> result;
    for (const auto& [region, overlap] : overlaps) {
        if (overlap.label == 0)
            throw InvalidInput({"label map", "region " + std::to_string(region) + " of the mesh has no voxel",
                                "the map that the mesh was made from", ""});
        RegionFidelity fidelity{.region = region};
        fidelity.label_volume = static_cast<double>(overlap.label) * map.grid.voxel_volume();
        fidelity.volume_error_percent = 100 * (volumes[region] / fidelity.label_volume - 1);
        fidelity.dice =
            2 * static_cast<double>(overlap.both) / static_cast<double>(overlap.label + overlap.painted);
        const auto mean = [&](const Eigen::Vector3d& sum, std::int64_t count) -> Eigen::Vector3d {
            return map.grid.point_of(sum / static_cast<double>(std::max<std::int64_t>(1, count)));
        };
        fidelity.centroid_distance =
            (mean(overlap.painted_sum, overlap.painted) - mean(overlap.label_sum, overlap.label)).norm();
        result.push_back(fidelity);
    }
    return result;
}

}  // namespace palpate
