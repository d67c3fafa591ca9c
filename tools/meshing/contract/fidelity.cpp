// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/meshing/contract/fidelity.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "formats/model/errors.hpp"

namespace palpate::meshing {
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

// Voxel counts and index sums of a label, of a region's paint, and of both at once; the mesh's volume.
struct Overlap {
    std::int64_t label = 0, painted = 0, both = 0;
    Eigen::Vector3d label_sum = Eigen::Vector3d::Zero(), painted_sum = Eigen::Vector3d::Zero();
    double mesh_volume = 0;
};

RegionFidelity fidelity_of(std::int32_t region, const Overlap& overlap, const ImageGrid& grid) {
    RegionFidelity fidelity{.region = region};
    fidelity.label_volume = static_cast<double>(overlap.label) * grid.voxel_volume();
    fidelity.volume_error_percent = 100 * (overlap.mesh_volume / fidelity.label_volume - 1);
    fidelity.dice =
        2 * static_cast<double>(overlap.both) / static_cast<double>(overlap.label + overlap.painted);
    const auto mean = [&](const Eigen::Vector3d& sum, std::int64_t count) -> Eigen::Vector3d {
        return grid.point_of(sum / static_cast<double>(std::max<std::int64_t>(1, count)));
    };
    fidelity.centroid_distance =
        (mean(overlap.painted_sum, overlap.painted) - mean(overlap.label_sum, overlap.label)).norm();
    return fidelity;
}

}  // namespace

std::vector<std::int32_t> voxelise(const TetMesh& mesh, const ImageGrid& grid) {
    std::vector<std::int32_t> voxels(grid.voxel_count(), 0);
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
        Eigen::Matrix<double, 3, 4> corners;
        for (std::size_t c = 0; c < 4; ++c)
            corners.col(static_cast<Eigen::Index>(c)) =
                grid.index_of(mesh.rest_positions[mesh.tetrahedra[t][c]]);
        paint(corners, mesh.regions[t], grid, voxels);
    }
    return voxels;
}

BodyFidelity compare(const TetMesh& mesh, const RegionLabels& labels) {
    return compare(mesh, labels, voxelise(mesh, labels.grid));
}

BodyFidelity compare(const TetMesh& mesh, const RegionLabels& labels, std::span<const std::int32_t> painted) {
    // Regions by number, 1, 2, ...; entry 0 is the body.
    std::vector<Overlap> overlaps(labels.values.size() + 1);
    std::map<std::int32_t, std::size_t> number_of;
    for (std::size_t k = 0; k < labels.values.size(); ++k) number_of[labels.values[k]] = k + 1;
    const auto number = [&](std::int32_t region) {
        const auto found = number_of.find(region);
        if (found == number_of.end())
            throw InvalidInput({"label map", "lacks region " + std::to_string(region) + " of the mesh",
                                "the map that the mesh was made from", ""});
        return found->second;
    };
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
        for (const std::size_t k : {number(mesh.regions[t]), std::size_t{0}})
            overlaps[k].mesh_volume += six_volume(mesh, t) / 6;

    std::size_t offset = 0;
    for (std::int32_t k = 0; k < labels.grid.size[2]; ++k)
        for (std::int32_t j = 0; j < labels.grid.size[1]; ++j)
            for (std::int32_t i = 0; i < labels.grid.size[0]; ++i, ++offset) {
                const std::size_t label = labels.regions[offset];
                const std::size_t paint = painted[offset] > 0 ? number(painted[offset]) : 0;
                if (label == 0 && paint == 0) continue;
                const Eigen::Vector3d index(i, j, k);
                if (label > 0)
                    for (const std::size_t own : {label, std::size_t{0}}) {
                        ++overlaps[own].label;
                        overlaps[own].label_sum += index;
                    }
                if (paint > 0)
                    for (const std::size_t own : {paint, std::size_t{0}}) {
                        ++overlaps[own].painted;
                        overlaps[own].painted_sum += index;
                    }
                if (label > 0 && label == paint) ++overlaps[label].both;
                if (label > 0 && paint > 0) ++overlaps[0].both;
            }

    BodyFidelity result{.body = fidelity_of(0, overlaps[0], labels.grid), .regions = {}};
    for (std::size_t k = 0; k < labels.values.size(); ++k)
        result.regions.push_back(fidelity_of(labels.values[k], overlaps[k + 1], labels.grid));
    return result;
}

}  // namespace palpate::meshing
