// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/seeds/slice_view.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <cmath>

namespace palpate::seeds {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double rim = 1e-6;  // voxels: keeps places on the volume's faces within their voxels when rounded

// For each of x, y, z of the patient the index axis nearest to it, each index axis once.
std::array<int, 3> nearest_axes(const Eigen::Matrix3d& direction) {
    std::array<int, 3> axes{0, 1, 2}, best = axes;
    double best_share = -1;
    do {
        double share = 0;
        for (int i = 0; i < 3; ++i) share += std::abs(direction(i, axes[i]));
        if (share > best_share + 1e-12) {
            best_share = share;
            best = axes;
        }
    } while (std::ranges::next_permutation(axes).found);
    return best;
}

char letter_of(const Vector3d& direction) {
    constexpr std::array<std::array<char, 2>, 3> letters{{{'R', 'L'}, {'A', 'P'}, {'I', 'S'}}};
    Eigen::Index axis = 0;
    direction.cwiseAbs().maxCoeff(&axis);
    return letters[axis][direction[axis] > 0 ? 1 : 0];
}

// A view whose rows run towards `right` and whose columns run towards `down` in P, as nearly as may be.
SliceView view_of(const std::string& name, const ImageGrid& grid, const Vector3d& right,
                  const Vector3d& down) {
    const std::array<int, 3> axes = nearest_axes(grid.direction);
    const auto axis_of = [&](const Vector3d& unit) {
        Eigen::Index axis = 0;
        unit.cwiseAbs().maxCoeff(&axis);
        return axes[axis];
    };
    SliceView view;
    view.name = name;
    view.right = axis_of(right);
    view.down = axis_of(down);
    view.across = 3 - view.right - view.down;
    Vector3d to_right = grid.direction.col(view.right), to_bottom = grid.direction.col(view.down);
    view.right_flipped = to_right.dot(right) < 0;
    view.down_flipped = to_bottom.dot(down) < 0;
    if (view.right_flipped) to_right = -to_right;
    if (view.down_flipped) to_bottom = -to_bottom;
    view.away = grid.direction.col(view.across).dot(to_right.cross(to_bottom)) > 0 ? 1 : -1;
    view.edges = {letter_of(-to_right), letter_of(to_right), letter_of(-to_bottom), letter_of(to_bottom)};
    return view;
}

// Distance from the picture's edge to a continuous index along one axis, and back.
double along(const ImageGrid& grid, int axis, bool flipped, double index) {
    const double voxels = flipped ? grid.size[axis] - 0.5 - index : index + 0.5;
    return voxels * grid.spacing[axis];
}

double index_along(const ImageGrid& grid, int axis, bool flipped, double distance) {
    const double voxels = distance / grid.spacing[axis];
    const double size = grid.size[axis];
    return std::clamp(flipped ? size - 0.5 - voxels : voxels - 0.5, -0.5 + rim, size - 0.5 - rim);
}

}  // namespace

std::array<SliceView, 3> slice_views(const ImageGrid& grid) {
    assert(grid.direction.isUnitary(1e-4));
    const Vector3d left = Vector3d::UnitX(), back = Vector3d::UnitY(), feet = -Vector3d::UnitZ();
    return {view_of("axial", grid, left, back), view_of("coronal", grid, left, feet),
            view_of("sagittal", grid, back, feet)};
}

Vector2d size_of(const SliceView& view, const ImageGrid& grid) {
    const auto length = [&](int axis) { return grid.size[axis] * grid.spacing[axis]; };
    return {length(view.right), length(view.down)};
}

Vector2d pane_point(const SliceView& view, const ImageGrid& grid, const Vector3d& index) {
    return {along(grid, view.right, view.right_flipped, index[view.right]),
            along(grid, view.down, view.down_flipped, index[view.down])};
}

std::optional<Vector3d> index_at(const SliceView& view, const ImageGrid& grid, std::int32_t slice,
                                 const Vector2d& point) {
    if ((point.array() < 0).any() || (point.array() >= size_of(view, grid).array()).any()) return {};
    Vector3d index;
    index[view.across] = slice;
    index[view.right] = index_along(grid, view.right, view.right_flipped, point[0]);
    index[view.down] = index_along(grid, view.down, view.down_flipped, point[1]);
    return index;
}

bool PaneFrame::holds(const Vector2d& position) const {
    return (position.array() >= corner.array()).all() && (position.array() < (corner + size).array()).all();
}

Vector2d PaneFrame::point_at(const Vector2d& position) const {
    const Vector2d from_middle = (position - corner - size / 2) * pixel;
    return center + Vector2d(from_middle[0], -from_middle[1]);
}

bool PaneFrame::shows(const Vector2d& point) const {
    constexpr double inner = 0.45;
    return ((point - center).array().abs() <= inner * pixel * size.array()).all();
}

}  // namespace palpate::seeds
