// SPDX-License-Identifier: GPL-3.0-or-later
// Recipes on phantoms, and how much of the truth they find.
#pragma once
#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "sample_data/phantoms.hpp"
#include "tools/imaging/recipes/segmentation.hpp"
#include "tools/imaging/voxels/mask.hpp"

namespace palpate::test {

inline imaging::Mask mask_of(const LabelMap& map, const std::string& name) {
    return imaging::mask_of(map, require_label(map, name, "test").value);
}

/// Overlap 2 |A and B| / (|A| + |B|).
inline double dice(const imaging::Mask& a, const imaging::Mask& b) {
    return 2 * static_cast<double>(imaging::intersect(a, b).count()) /
           static_cast<double>(a.count() + b.count());
}

inline double dice(const LabelMap& a, const std::string& name_a, const LabelMap& b,
                   const std::string& name_b) {
    return dice(mask_of(a, name_a), mask_of(b, name_b));
}

/// The label map that structures, as people write them, make.
inline LabelMap run(const Volume* volume, const LabelMap* prior, const std::vector<std::string>& texts) {
    std::vector<imaging::StructureRecipe> structures;
    for (const std::string& text : texts) structures.push_back(imaging::parse_structure(text));
    return imaging::segment(volume, prior, structures);
}

struct Imaging {
    std::string name;
    PhantomOptions options;
};

/// The ways in which the phantoms are imaged.
inline std::vector<Imaging> imagings() {
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(0.4, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
    const Eigen::Matrix3d flip = Eigen::Vector3d(1, -1, 1).asDiagonal();
    return {{"plain", {}},
            {"flipped and oblique", {.direction = turn * flip}},
            {"anisotropic", {.spacing = {1.5, 1.5, 3}}},
            {"noise and partial volume", {.samples_per_axis = 2, .noise_hu = 25}}};
}

// Voxels of 2 mm on structures of 5 ... 12 mm: half a voxel at the surface already costs a tenth.
inline constexpr double coarse_dice = 0.85;
inline constexpr double thick_dice = 0.93;

}  // namespace palpate::test
