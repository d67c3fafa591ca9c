// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/imaging/faces/face.hpp"

#include <algorithm>
#include <limits>
#include <optional>

#include "tools/imaging/voxels/coarse_grid.hpp"
#include "tools/imaging/voxels/hounsfield.hpp"
#include "tools/imaging/voxels/mask.hpp"

namespace palpate::imaging {
namespace {

constexpr double any_hu = std::numeric_limits<double>::infinity();
constexpr double tissue_hu = -300, air_hu = -1000;
constexpr double face_block_mm = 2;  // for what a face is, not for where it is cut

// The grid's axis that runs most along an axis of the patient.
std::size_t axis_along(const ImageGrid& grid, Eigen::Index patient_axis) {
    Eigen::Index axis = 0;
    grid.direction.row(patient_axis).cwiseAbs().maxCoeff(&axis);
    return static_cast<std::size_t>(axis);
}

// A volume in blocks, in HU.
Volume blocks_in_hu(const Volume& volume, const std::array<std::int32_t, 3>& block) {
    Volume blocks = coarsen(volume, block);
    const auto offset = static_cast<float>(hounsfield_offset(volume));
    for (float& value : blocks.values) value -= offset;
    return blocks;
}

// A section of a grid across one axis, and where its blocks are in memory.
struct Section {
    std::int32_t columns, rows;
    std::vector<std::size_t> offsets;
};

Section section_of(const ImageGrid& grid, std::size_t across, std::int32_t slice) {
    const std::size_t u = (across + 1) % 3, v = (across + 2) % 3;
    Section section{grid.size[u], grid.size[v], {}};
    std::array<std::int32_t, 3> index{};
    index[across] = slice;
    for (index[v] = 0; index[v] < grid.size[v]; ++index[v])
        for (index[u] = 0; index[u] < grid.size[u]; ++index[u])
            section.offsets.push_back(grid.offset(index[0], index[1], index[2]));
    return section;
}

// How many blocks of a section are soft tissue that no path to its border reaches around the wall.
std::size_t enclosed(const Section& section, const Mask& wall, const Mask& soft) {
    std::vector<std::uint8_t> reached(section.offsets.size(), 0);
    std::vector<std::size_t> border;
    const auto reach = [&](std::int32_t column, std::int32_t row) {
        if (column < 0 || row < 0 || column >= section.columns || row >= section.rows) return;
        const auto at = static_cast<std::size_t>(row) * static_cast<std::size_t>(section.columns) +
                        static_cast<std::size_t>(column);
        if (reached[at] || wall.voxels[section.offsets[at]]) return;
        reached[at] = 1;
        border.push_back(at);
    };
    for (std::int32_t column = 0; column < section.columns; ++column)
        for (const std::int32_t row : {0, section.rows - 1}) reach(column, row);
    for (std::int32_t row = 0; row < section.rows; ++row)
        for (const std::int32_t column : {0, section.columns - 1}) reach(column, row);
    while (!border.empty()) {
        const auto at = static_cast<std::int32_t>(border.back());
        border.pop_back();
        const std::int32_t column = at % section.columns, row = at / section.columns;
        reach(column - 1, row);
        reach(column + 1, row);
        reach(column, row - 1);
        reach(column, row + 1);
    }
    std::size_t count = 0;
    for (std::size_t at = 0; at < reached.size(); ++at)
        count += !reached[at] && !wall.voxels[section.offsets[at]] && soft.voxels[section.offsets[at]];
    return count;
}

// The slices across the patient's height from the first to the last in which bone encloses a brain.
struct Skull {
    std::size_t axis;
    std::int32_t first, last;
};

std::optional<Skull> skull_of(const Volume& hounsfield) {
    constexpr double least_mm2 = 3000, gap_mm = 4, least_height_mm = 10, soft_hu = 120;
    const ImageGrid& grid = hounsfield.grid;
    const std::size_t axis = axis_along(grid, 2);
    const Mask wall = close(threshold(hounsfield, bone_from_hu, any_hu), gap_mm);
    const Mask soft = threshold(hounsfield, tissue_hu, soft_hu);
    const double step = grid.spacing[static_cast<Eigen::Index>(axis)], area = grid.voxel_volume() / step;
    std::optional<Skull> skull;
    double height = 0;  // of the slices alone: bone is thin in places, and noses and cuts open it
    for (std::int32_t slice = 0; slice < grid.size[axis]; ++slice) {
        if (static_cast<double>(enclosed(section_of(grid, axis, slice), wall, soft)) * area < least_mm2)
            continue;
        if (!skull) skull = Skull{axis, slice, slice};
        skull->last = slice;
        height += step;
    }
    return height >= least_height_mm ? skull : std::nullopt;
}

// Bone without table and head rest, closed over what lies between.
Mask hull_of(const Volume& hounsfield) {
    constexpr double apart_mm = 4, gap_mm = 30, least_mm3 = 1000;
    const Mask bone = bone_of_body(hounsfield, bone_from_hu, apart_mm);
    return close(drop_small(bone, least_mm3), gap_mm);
}

// Whether the front is where the index along the patient's depth is high: where the air between bone and bone
// lies from their middle, row by row, or, where that does not tell, by the grid's directions.
bool front_is_high(const Volume& hounsfield, const Mask& hull, std::size_t depth) {
    constexpr double air_below_hu = -400, telling_mm = 5, least_mm3 = 3000;
    const ImageGrid& grid = hounsfield.grid;
    const std::size_t u = (depth + 1) % 3, v = (depth + 2) % 3;
    double air = 0, forward = 0;
    std::array<std::int32_t, 3> index{};
    const auto offset_at = [&](std::int32_t at) {
        index[depth] = at;
        return grid.offset(index[0], index[1], index[2]);
    };
    for (index[v] = 0; index[v] < grid.size[v]; ++index[v])
        for (index[u] = 0; index[u] < grid.size[u]; ++index[u]) {
            std::int32_t first = 0, last = grid.size[depth] - 1;
            while (first <= last && !hull.voxels[offset_at(first)]) ++first;
            while (last > first && !hull.voxels[offset_at(last)]) --last;
            for (std::int32_t at = first; at <= last; ++at)
                if (hounsfield.values[offset_at(at)] < air_below_hu) {
                    ++air;
                    forward += at - 0.5 * (first + last);
                }
        }
    const double mean_mm = forward / std::max(air, 1.0) * grid.spacing[static_cast<Eigen::Index>(depth)];
    if (air * grid.voxel_volume() >= least_mm3 && std::abs(mean_mm) > telling_mm) return mean_mm > 0;
    return grid.direction(1, static_cast<Eigen::Index>(depth)) < 0;
}

// Blocks from the skin to the bone behind it, row by row from the front, where it is `thinnest_mm` or more
// away, and `margin_mm` around that.
Mask face_of(const Volume& hounsfield, const Skull& skull, double thinnest_mm, double margin_mm) {
    constexpr double thickest_mm = 40, beyond_skull_mm = 120;
    const ImageGrid& grid = hounsfield.grid;
    const Mask tissue = keep_largest(threshold(hounsfield, tissue_hu, any_hu));
    const Mask hull = hull_of(hounsfield);
    const std::size_t depth = axis_along(grid, 1), width = 3 - depth - skull.axis;
    const bool from_high = front_is_high(hounsfield, hull, depth);
    const auto beyond =
        static_cast<std::int32_t>(beyond_skull_mm / grid.spacing[static_cast<Eigen::Index>(skull.axis)]);
    const std::int32_t first = std::max(0, skull.first - beyond),
                       last = std::min(grid.size[skull.axis] - 1, skull.last + beyond);
    const double step_mm = grid.spacing[static_cast<Eigen::Index>(depth)];
    Mask face{grid, std::vector<std::uint8_t>(hounsfield.values.size())};
    std::array<std::int32_t, 3> index{};
    const auto offset_at = [&](std::int32_t step) {
        index[depth] = from_high ? grid.size[depth] - 1 - step : step;
        return grid.offset(index[0], index[1], index[2]);
    };
    for (index[skull.axis] = first; index[skull.axis] <= last; ++index[skull.axis])
        for (index[width] = 0; index[width] < grid.size[width]; ++index[width]) {
            std::int32_t skin = 0;
            while (skin < grid.size[depth] && !tissue.voxels[offset_at(skin)]) ++skin;
            std::int32_t bone_at = skin;
            while (bone_at < grid.size[depth] && !hull.voxels[offset_at(bone_at)]) ++bone_at;
            const double thickness = (bone_at - skin) * step_mm;
            if (bone_at == grid.size[depth] || thickness > thickest_mm || thickness < thinnest_mm) continue;
            for (std::int32_t step = skin; step < bone_at; ++step) face.voxels[offset_at(step)] = 1;
        }
    return subtract(dilate(face, margin_mm), hull);
}

}  // namespace

bool shows_head(const Volume& volume) {
    constexpr double least_share = 0.2;
    if (!is_ct(volume)) return false;
    const Volume blocks = blocks_in_hu(volume, blocks_of(volume.grid, face_block_mm));
    const auto skull = skull_of(blocks);
    return skull && skull->last + 1 - skull->first >= least_share * blocks.grid.size[skull->axis];
}

bool shows_face(const Volume& volume) {
    constexpr double least_mm3 = 20'000, thinnest_mm = 6;  // noses and lips, not what is left at the bone
    if (!is_ct(volume)) return false;
    const Volume blocks = blocks_in_hu(volume, blocks_of(volume.grid, face_block_mm));
    const auto skull = skull_of(blocks);
    if (!skull) return false;
    const Mask skin =
        intersect(face_of(blocks, *skull, thinnest_mm, 0), threshold(blocks, tissue_hu, any_hu));
    return static_cast<double>(skin.count()) * skin.grid.voxel_volume() >= least_mm3;
}

bool shows_face(const Scan& scan) {
    return scan.hounsfield && shows_face(Volume{scan.grid, {scan.values.begin(), scan.values.end()}});
}

Volume without_face(const Volume& volume) {
    constexpr double margin_mm =
        2 * face_block_mm;  // the skin's outermost voxels lie in blocks that are mostly air
    const auto block = blocks_of(volume.grid, face_block_mm);
    const Volume blocks = blocks_in_hu(volume, block);
    const auto skull = skull_of(blocks);
    if (!skull) return volume;
    const Mask face = refine(face_of(blocks, *skull, 0, margin_mm), {0, 0, 0}, block, volume.grid);
    const auto air = static_cast<float>(air_hu + hounsfield_offset(volume));
    Volume result = volume;
    for (std::size_t i = 0; i < result.values.size(); ++i)
        if (face.voxels[i]) result.values[i] = std::min(result.values[i], air);
    return result;
}

}  // namespace palpate::imaging
