// SPDX-License-Identifier: GPL-3.0-or-later
// Image files written byte by byte from their specifications: an oracle that shares no code with the readers.
#pragma once
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <numeric>
#include <span>
#include <string>
#include <vector>

#include "formats/model/image_grid.hpp"

namespace palpate::test {

inline std::string bytes_of(const std::filesystem::path& path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

inline void write_bytes(const std::filesystem::path& path, const std::string& bytes) {
    std::ofstream(path, std::ios::binary) << bytes;
}

template <typename Voxel>
std::string raw_bytes(std::span<const Voxel> voxels) {
    return {reinterpret_cast<const char*>(voxels.data()), voxels.size_bytes()};
}

/// The voxel axes as columns, scaled to mm, in LPS or (first two rows negated) RAS.
inline Eigen::Matrix3d scaled_axes(const ImageGrid& grid, bool ras) {
    Eigen::Matrix3d axes = grid.direction * grid.spacing.asDiagonal();
    if (ras) axes.topRows<2>() *= -1;
    return axes;
}

inline Eigen::Vector3d origin_in(const ImageGrid& grid, bool ras) {
    return ras ? Eigen::Vector3d(-grid.origin[0], -grid.origin[1], grid.origin[2]) : grid.origin;
}

/// NRRD with raw encoding; `space` is "left-posterior-superior" or "right-anterior-superior".
inline std::string nrrd_file(const ImageGrid& grid, const std::string& type, const std::string& voxels,
                             const std::string& space, const std::string& more_fields = "") {
    const bool ras = space.starts_with("right");
    const Eigen::Matrix3d axes = scaled_axes(grid, ras);
    const Eigen::Vector3d origin = origin_in(grid, ras);
    std::string text =
        fmt::format("NRRD0004\ntype: {}\ndimension: 3\nspace: {}\nsizes: {} {} {}\nspace directions:", type,
                    space, grid.size[0], grid.size[1], grid.size[2]);
    for (int axis = 0; axis < 3; ++axis)
        text += fmt::format(" ({},{},{})", axes(0, axis), axes(1, axis), axes(2, axis));
    return text +
           fmt::format("\nendian: little\nencoding: raw\nspace origin: ({},{},{})\n{}\n", origin[0],
                       origin[1], origin[2], more_fields) +
           voxels;
}

inline std::string meta_file(const ImageGrid& grid, const std::string& type, const std::string& voxels) {
    std::string matrix;
    for (int axis = 0; axis < 3; ++axis)
        for (int row = 0; row < 3; ++row) matrix += fmt::format(" {}", grid.direction(row, axis));
    return fmt::format(
               "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n"
               "TransformMatrix ={}\nOffset = {} {} {}\nElementSpacing = {} {} {}\nDimSize = {} {} {}\n"
               "ElementType = {}\nElementDataFile = LOCAL\n",
               matrix, grid.origin[0], grid.origin[1], grid.origin[2], grid.spacing[0], grid.spacing[1],
               grid.spacing[2], grid.size[0], grid.size[1], grid.size[2], type) +
           voxels;
}

/// NIfTI-1 single file with the affine in the sform (code 1), no qform; voxels are float32.
inline std::string nifti_file(const ImageGrid& grid, const std::string& voxels) {
    std::string header(352, '\0');
    const auto put = [&](std::size_t offset, auto value) {
        std::memcpy(header.data() + offset, &value, sizeof(value));
    };
    put(0, std::int32_t{348});
    put(40, std::int16_t{3});
    for (std::size_t axis = 0; axis < 3; ++axis)
        put(42 + 2 * axis, static_cast<std::int16_t>(grid.size[axis]));
    for (std::size_t axis = 3; axis < 7; ++axis) put(42 + 2 * axis, std::int16_t{1});
    put(70, std::int16_t{16});  // datatype: float32
    put(72, std::int16_t{32});
    put(76, 1.0F);
    for (std::size_t axis = 0; axis < 3; ++axis)
        put(80 + 4 * axis, static_cast<float>(grid.spacing[static_cast<Eigen::Index>(axis)]));
    put(108, 352.0F);
    put(112, 1.0F);      // scl_slope
    header[123] = '\2';  // millimetres
    put(254, std::int16_t{1});
    const Eigen::Matrix3d axes = scaled_axes(grid, true);
    const Eigen::Vector3d origin = origin_in(grid, true);
    for (int row = 0; row < 3; ++row) {
        for (int axis = 0; axis < 3; ++axis)
            put(static_cast<std::size_t>(280 + 16 * row + 4 * axis), static_cast<float>(axes(row, axis)));
        put(static_cast<std::size_t>(280 + 16 * row + 12), static_cast<float>(origin[row]));
    }
    std::memcpy(header.data() + 344, "n+1", 4);
    return header + voxels;
}

/// Values that all differ, in voxels whose edges do, on axes of no frame.
inline Volume oblique_ramp() {
    Volume volume;
    volume.grid.size = {4, 5, 6};
    volume.grid.spacing = {0.5, 0.75, 1.25};
    volume.grid.origin = {-10.5, 20.25, 30.125};
    volume.grid.direction = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, -2, 3).normalized()).toRotationMatrix();
    volume.values.resize(volume.grid.voxel_count());
    std::iota(volume.values.begin(), volume.values.end(), -7.0F);
    return volume;
}

}  // namespace palpate::test
