// SPDX-License-Identifier: Apache-2.0
#include "formats/model/image_grid.hpp"

#include <cassert>

namespace palpate {

std::size_t ImageGrid::voxel_count() const {
    return static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]) *
           static_cast<std::size_t>(size[2]);
}

double ImageGrid::voxel_volume() const {
    return spacing.prod();
}

Eigen::Vector3d ImageGrid::point_of(const Eigen::Vector3d& index) const {
    return origin + direction * spacing.cwiseProduct(index);
}

Eigen::Vector3d ImageGrid::index_of(const Eigen::Vector3d& p_P) const {
    assert(direction.isUnitary(1e-4));  // what a header's decimals leave
    return (direction.transpose() * (p_P - origin)).cwiseQuotient(spacing);
}

bool same_grid(const ImageGrid& a, const ImageGrid& b) {
    if (a.size != b.size) return false;
    const double tolerance = 1e-4;  // mm: far below any voxel, far above float32 header round-off
    for (int corner = 0; corner < 8; ++corner) {
        Eigen::Vector3d index;
        for (int axis = 0; axis < 3; ++axis) index[axis] = (corner >> axis & 1) ? a.size[axis] : 0;
        if ((a.point_of(index) - b.point_of(index)).norm() > tolerance) return false;
    }
    return true;
}

}  // namespace palpate
