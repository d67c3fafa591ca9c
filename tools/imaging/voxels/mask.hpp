// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "formats/model/image_grid.hpp"
#include "formats/model/label_map.hpp"

namespace palpate::imaging {

/// A set of voxels. Radii and distances are Euclidean, in mm, between voxel centres, whatever the spacing;
/// what lies beyond the grid's border counts as unknown, neither inside nor outside.
struct Mask {
    ImageGrid grid;
    std::vector<std::uint8_t> voxels;  ///< voxel_count() values, 1 inside and 0 outside, i fastest

    std::size_t count() const;
};

/// A part of space in P: the intersection of a sphere and a box along the patient axes; all of P if neither.
struct Region {
    struct Sphere {
        Eigen::Vector3d center;  ///< p_P, mm
        double radius;           ///< mm
    };
    struct Box {
        Eigen::Vector3d low, high;  ///< p_P, mm
    };
    std::optional<Sphere> sphere;
    std::optional<Box> box;

    bool contains(const Eigen::Vector3d& p_P) const;
};

/// Face-connected pieces of a mask, numbered from 1 by falling size, equal sizes in scan order.
struct Components {
    std::vector<std::uint32_t> labels;  ///< one per voxel, 0 outside the mask
    std::vector<std::size_t> sizes;     ///< voxels of piece n at [n - 1]
};

Components components_of(const Mask& mask);

/// The pieces for which `keep(number)` holds, numbered as in Components.
Mask select(const Mask& mask, const Components& pieces, const std::function<bool(std::uint32_t)>& keep);

Mask keep_largest(const Mask& mask);
/// Drops face-connected pieces smaller than `volume` (mm³).
Mask drop_small(const Mask& mask, double volume);

/// Distance from each voxel to the nearest voxel of `mask` (mm), 0 inside; infinite if the mask is empty.
/// Cost: linear in voxels (Maurer, Qi and Raghavan, 2003).
std::vector<float> distance_to(const Mask& mask);

/// Distance from each voxel of the mask to the nearest voxel outside it (mm), 0 outside.
std::vector<float> depth_in(const Mask& mask);

/// The voxels labelled `value`.
Mask mask_of(const LabelMap& map, std::int32_t value);
/// The voxels with any label.
Mask labelled(const LabelMap& map);

/// Indices of voxels, both ends included; empty if `high` is below `low` along an axis.
struct IndexBox {
    Eigen::Array3i low, high;
};
/// The voxels of the grid whose indices may lie within `reach` (mm) of `p_P` (mm).
IndexBox voxels_around(const ImageGrid& grid, const Eigen::Vector3d& p_P, double reach);

/// The offset of the voxel of `mask` nearest to `p_P` (mm), at most `reach` (mm) away; none if there is none.
std::optional<std::size_t> nearest_voxel(const Mask& mask, const Eigen::Vector3d& p_P, double reach);

/// Voxels within `radius` (mm) of the mask; radius 0 changes nothing, here and below.
Mask dilate(const Mask& mask, double radius);
Mask erode(const Mask& mask, double radius);
/// Removes what a ball of `radius` does not fit into.
Mask open(const Mask& mask, double radius);
/// Fills gaps that a ball of `radius` does not fit into.
Mask close(const Mask& mask, double radius);
/// Adds the background that the grid's border cannot be reached from by face steps.
Mask fill_holes(const Mask& mask);

/// Rounds the border off: the mask's Gaussian mean with deviation `size` / 2 (mm), cut where as many voxels
/// lie inside as before, so that the volume stays; size 0 changes nothing.
Mask smooth(const Mask& mask, double size);

Mask intersect(const Mask& a, const Mask& b);
Mask subtract(const Mask& a, const Mask& b);
Mask clip(const Mask& mask, const Region& region);

}  // namespace palpate::imaging
