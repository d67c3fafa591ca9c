// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/imaging/voxels/bone_inside.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <vector>

namespace palpate::imaging {
namespace {

using Eigen::Vector3d;

constexpr double dense_hu = 300;

// Calls `visit` with the offset of each voxel whose middle is in the tetrahedron with these corners
// (indices).
template <typename Visit>
void for_each_voxel(const std::array<Vector3d, 4>& corners, const ImageGrid& grid, const Visit& visit) {
    Eigen::Matrix3d edges;
    edges << corners[1] - corners[0], corners[2] - corners[0], corners[3] - corners[0];
    if (edges.determinant() == 0) return;
    const Eigen::Matrix3d inverse = edges.inverse();
    Eigen::AlignedBox3d box;
    for (const Vector3d& corner : corners) box.extend(corner);
    std::array<std::int32_t, 3> first{}, last{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto a = static_cast<Eigen::Index>(axis);
        first[axis] = static_cast<std::int32_t>(std::ceil(std::max(0.0, box.min()[a])));
        last[axis] = static_cast<std::int32_t>(std::floor(std::min(grid.size[axis] - 1.0, box.max()[a])));
    }
    for (std::int32_t k = first[2]; k <= last[2]; ++k)
        for (std::int32_t j = first[1]; j <= last[1]; ++j)
            for (std::int32_t i = first[0]; i <= last[0]; ++i) {
                const Vector3d weights = inverse * (Vector3d(i, j, k) - corners[0]);
                if (weights.minCoeff() >= 0 && weights.sum() <= 1) visit(grid.offset(i, j, k));
            }
}

}  // namespace

BoneInside bone_inside(const TetMesh& mesh, const Scan& scan) {
    if (!scan.hounsfield) return {};
    std::int64_t all = 0, dense = 0;
    std::vector<bool> counted(scan.values.size());  // a voxel on a face is in two
    for (const Tetrahedron& nodes : mesh.tetrahedra) {
        std::array<Vector3d, 4> corners;
        for (std::size_t c = 0; c < 4; ++c)
            corners[c] = scan.grid.index_of(mesh.rest_positions[static_cast<std::size_t>(nodes[c])]);
        for_each_voxel(corners, scan.grid, [&](std::size_t offset) {
            if (counted[offset]) return;
            counted[offset] = true;
            ++all;
            dense += scan.values[offset] >= dense_hu;
        });
    }
    if (all == 0) return {};
    return {static_cast<double>(dense) * scan.grid.voxel_volume(),
            static_cast<double>(dense) / static_cast<double>(all)};
}

std::string bone_text(const BoneInside& found) {
    constexpr double least_volume = 500, least_share = 0.01;  // mm³
    if (found.volume < least_volume || found.share < least_share) return "";
    return fmt::format(
        "holds {:.1f} ml ({:.0f} %) of {:g} HU and more, as bone, calcium or a vessel full of contrast has, "
        "and is "
        "as soft there as elsewhere",
        found.volume / 1000, 100 * found.share, dense_hu);
}

}  // namespace palpate::imaging
