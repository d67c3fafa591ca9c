// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Geometry>
#include <array>
#include <functional>

#include "formats/model/label_map.hpp"

namespace palpate::test {

/// An anisotropic grid whose middle is `center`, turned by `direction`.
inline ImageGrid grid_around(const Eigen::Vector3d& center, const Eigen::Matrix3d& direction,
                             std::array<std::int32_t, 3> size) {
    ImageGrid grid;
    grid.size = size;
    grid.spacing = {0.9, 1.0, 1.4};
    grid.direction = direction;
    grid.origin =
        center - direction * grid.spacing.cwiseProduct(
                                 0.5 * (Eigen::Vector3d(size[0], size[1], size[2]).array() - 1).matrix());
    return grid;
}

/// Labels every voxel by where its centre lies.
inline LabelMap paint(const ImageGrid& grid, const std::function<int(const Eigen::Vector3d&)>& label_at,
                      std::vector<Label> names) {
    LabelMap map{grid, std::vector<std::uint16_t>(grid.voxel_count()), std::move(names)};
    for (std::int32_t k = 0; k < grid.size[2]; ++k)
        for (std::int32_t j = 0; j < grid.size[1]; ++j)
            for (std::int32_t i = 0; i < grid.size[0]; ++i)
                map.labels[grid.offset(i, j, k)] =
                    static_cast<std::uint16_t>(label_at(grid.point_of({1.0 * i, 1.0 * j, 1.0 * k})));
    return map;
}

inline const Eigen::Vector3d organ_center{-31.0, 47.0, -120.0};
inline const Eigen::Vector3d lesion_center = organ_center + Eigen::Vector3d(4, -5, 3);

/// The labels of organ_with_lesion(): the organ, and the lesion in it.
inline constexpr std::array<std::int32_t, 2> organ_and_lesion{3, 7};

/// An organ (3), a ball of 20 mm radius, with an enclosed lesion (7) of 6.5 mm (1.15 ml), and bone (12) where
/// x is more than 15 mm beyond the organ's centre.
inline LabelMap organ_with_lesion(const Eigen::Matrix3d& direction = Eigen::Matrix3d::Identity()) {
    return paint(grid_around(organ_center, direction, {70, 64, 46}),
                 [](const Eigen::Vector3d& p) {
                     if ((p - lesion_center).norm() < 6.5) return 7;
                     if (p.x() - organ_center.x() > 15) return 12;
                     return (p - organ_center).norm() < 20 ? 3 : 0;
                 },
                 {{3, "organ"}, {7, "lesion"}, {12, "bone"}});
}

}  // namespace palpate::test
