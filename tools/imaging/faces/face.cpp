// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/imaging/faces/face.hpp"

#include <algorithm>
#include <limits>

#include "tools/imaging/voxels/coarse_grid.hpp"
#include "tools/imaging/voxels/hounsfield.hpp"
#include "tools/imaging/voxels/mask.hpp"

namespace palpate::imaging {
namespace {

constexpr double any_hu = std::numeric_limits<double>::infinity();
constexpr double tissue_hu = -300, skull_hu = 226, air_hu = -1000;
constexpr double face_block_mm = 2;  // for what a face is, not for where it is cut

// The grid's axis that runs most along an axis of the patient.
Eigen::Index axis_along(const ImageGrid& grid, Eigen::Index patient_axis) {
    Eigen::Index axis = 0;
    grid.direction.row(patient_axis).cwiseAbs().maxCoeff(&axis);
    return axis;
}

// A volume in blocks, in HU.
Volume blocks_in_hu(const Volume& volume, const std::array<std::int32_t, 3>& block) {
    Volume blocks = coarsen(volume, block);
    const auto offset = static_cast<float>(hounsfield_offset(volume));
    for (float& value : blocks.values) value -= offset;
    return blocks;
}

// Table and head rest come off where they hang together with the body by less than that.
Mask body_of(const Volume& hounsfield) {
    constexpr double apart_mm = 4;
    return keep_largest(open(threshold(hounsfield, tissue_hu, any_hu), apart_mm));
}

// Blocks from the skin to the bone behind it, row by row from the front, where it is `thinnest_mm` or more
// away, and `margin_mm` around that.
Mask face_of(const Volume& hounsfield, double thinnest_mm, double margin_mm) {
    constexpr double gap_mm = 30, thickest_mm = 40, skin_mm = 4;
    const ImageGrid& grid = hounsfield.grid;
    const Mask tissue = keep_largest(threshold(hounsfield, tissue_hu, any_hu));
    const Mask bone =
        intersect(threshold(hounsfield, skull_hu, any_hu), dilate(body_of(hounsfield), skin_mm));
    const Mask hull = close(drop_small(bone, 1000), gap_mm);
    const Eigen::Index along = axis_along(grid, 1);
    const bool backwards = grid.direction(1, along) < 0;  // index grows to the front
    const auto axis = static_cast<std::size_t>(along), second = (axis + 1) % 3, third = (axis + 2) % 3;
    Mask face{grid, std::vector<std::uint8_t>(hounsfield.values.size())};
    std::array<std::int32_t, 3> index{};
    const auto offset_at = [&](std::int32_t step) {
        index[axis] = backwards ? grid.size[axis] - 1 - step : step;
        return grid.offset(index[0], index[1], index[2]);
    };
    for (index[third] = 0; index[third] < grid.size[third]; ++index[third])
        for (index[second] = 0; index[second] < grid.size[second]; ++index[second]) {
            std::int32_t skin = 0;
            while (skin < grid.size[axis] && !tissue.voxels[offset_at(skin)]) ++skin;
            std::int32_t bone_at = skin;
            while (bone_at < grid.size[axis] && !hull.voxels[offset_at(bone_at)]) ++bone_at;
            const double thickness = (bone_at - skin) * grid.spacing[along];
            if (bone_at == grid.size[axis] || thickness > thickest_mm || thickness < thinnest_mm) continue;
            for (std::int32_t step = skin; step < bone_at; ++step) face.voxels[offset_at(step)] = 1;
        }
    return subtract(dilate(face, margin_mm), hull);
}

}  // namespace

bool shows_head(const Volume& volume) {
    constexpr double largest_head_mm2 = 35'000;
    if (!is_ct(volume)) return false;
    const Mask body = body_of(blocks_in_hu(volume, blocks_of(volume.grid, face_block_mm)));
    const Eigen::Index axis = axis_along(volume.grid, 2);
    const double height = body.grid.size[static_cast<std::size_t>(axis)] * body.grid.spacing[axis];
    return static_cast<double>(body.count()) * body.grid.voxel_volume() / height < largest_head_mm2;
}

bool shows_face(const Volume& volume) {
    constexpr double least_mm3 = 20'000, thinnest_mm = 6;  // noses and lips, not what is left at the bone
    if (!shows_head(volume)) return false;
    const Volume blocks = blocks_in_hu(volume, blocks_of(volume.grid, face_block_mm));
    const Mask skin = intersect(face_of(blocks, thinnest_mm, 0), threshold(blocks, tissue_hu, any_hu));
    return static_cast<double>(skin.count()) * skin.grid.voxel_volume() >= least_mm3;
}

Volume without_face(const Volume& volume) {
    constexpr double margin_mm =
        2 * face_block_mm;  // the skin's outermost voxels lie in blocks that are mostly air
    const auto block = blocks_of(volume.grid, face_block_mm);
    const Mask face =
        refine(face_of(blocks_in_hu(volume, block), 0, margin_mm), {0, 0, 0}, block, volume.grid);
    const auto air = static_cast<float>(air_hu + hounsfield_offset(volume));
    Volume result = volume;
    for (std::size_t i = 0; i < result.values.size(); ++i)
        if (face.voxels[i]) result.values[i] = std::min(result.values[i], air);
    return result;
}

}  // namespace palpate::imaging
