// SPDX-License-Identifier: Apache-2.0
// Apart from the constructor, which allocates and throws: the tick's objects do neither.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "runtime/collision/field/distance_field.hpp"

namespace palpate::collision {

using Eigen::Vector3d;

// The cell that holds a point, and where in it that is.
struct DistanceField::Cell {
    Place place;
    Eigen::Vector3i corner;  // the cell's first sample, in its brick
    Vector3d part;           // of the cell's edges, 0 ... 1
};

// False beyond the grid, and for what is no number.
bool DistanceField::find_cell(const Vector3d& p, Cell& cell) const noexcept {
    Eigen::Vector3i brick;
    for (int axis = 0; axis < 3; ++axis) {
        const double voxels = (p[axis] - origin_[axis]) * per_voxel_;
        if (!(voxels >= 0 && voxels < brick_cells * bricks_[axis])) return false;
        const auto whole = static_cast<std::int32_t>(voxels);  // of what is not negative, the floor
        brick[axis] = whole / brick_cells;
        cell.corner[axis] = whole % brick_cells;
        cell.part[axis] = voxels - whole;
    }
    cell.place = places_[place_of(brick)];
    return true;
}

FieldSample DistanceField::interpolate(const Cell& cell) const noexcept {
    constexpr std::size_t row = brick_samples, slice = row * row;
    const float* const v = &samples_[static_cast<std::size_t>(cell.place.brick) * samples_of_a_brick +
                                     in_brick(cell.corner[0], cell.corner[1], cell.corner[2])];
    const double x = cell.part[0], y = cell.part[1], z = cell.part[2];
    // Along x on the cell's four edges that lie along x, with the slopes there.
    const double s00 = double{v[1]} - v[0], s10 = double{v[row + 1]} - v[row],
                 s01 = double{v[slice + 1]} - v[slice], s11 = double{v[slice + row + 1]} - v[slice + row];
    const double d00 = v[0] + x * s00, d10 = v[row] + x * s10, d01 = v[slice] + x * s01,
                 d11 = v[slice + row] + x * s11;
    // Then along y on the two faces across z, then along z.
    const double d0 = d00 + y * (d10 - d00), d1 = d01 + y * (d11 - d01);
    const double s0 = s00 + y * (s10 - s00), s1 = s01 + y * (s11 - s01);
    const Vector3d per_cell(s0 + z * (s1 - s0), (d10 - d00) + z * ((d11 - d01) - (d10 - d00)), d1 - d0);
    return {d0 + z * (d1 - d0), per_cell * per_voxel_};
}

FieldSample DistanceField::at(const Vector3d& p) const noexcept {
    Cell cell;
    if (!find_cell(p, cell)) return {.distance = band_};
    if (cell.place.brick >= 0) return interpolate(cell);
    return {.distance = far_distance(cell.place.brick)};
}

double DistanceField::clearance(const Vector3d& p) const noexcept {
    Cell cell;
    if (!find_cell(p, cell)) return (p - p.cwiseMax(low_).cwiseMin(high_)).norm();
    if (cell.place.brick >= 0) return std::max(std::abs(interpolate(cell).distance) - error(), 0.0);
    const Vector3d in_voxels = cell.corner.cast<double>() + cell.part - Vector3d::Constant(0.5 * brick_cells);
    return std::max(cell.place.free_radius - voxel_ * in_voxels.norm(), band_ - error());
}

double DistanceField::error() const noexcept {
    constexpr double float_rounding = 0x1p-24;  // relative
    return std::numbers::sqrt3 / 2 * voxel_ + float_rounding * band_;
}

}  // namespace palpate::collision
