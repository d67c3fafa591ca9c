// SPDX-License-Identifier: GPL-3.0-or-later
// NIfTI-1 and NIfTI-2 single files, read here rather than through ITK 5.2, which refuses directions 4e-4 off
// orthonormality and hides that qform and sform disagree.
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "formats/model/errors.hpp"
#include "tools/imaging/files/label_names.hpp"
#include "tools/imaging/files/nifti_header.hpp"
#include "tools/imaging/files/read_image.hpp"

namespace palpate::imaging {
namespace {

constexpr std::size_t largest_header = std::size_t{1} << 26;

void swap_bytes(std::span<std::byte> bytes, std::size_t width) {
    for (std::size_t at = 0; width > 1 && at + width <= bytes.size(); at += width)
        std::ranges::reverse(bytes.subspan(at, width));
}

ImageGrid grid_of(const NiftiHeader& header, Eigen::Matrix<double, 3, 4> affine) {
    ImageGrid grid;
    for (std::size_t axis = 0; axis < 3; ++axis)
        grid.size[axis] = static_cast<std::int32_t>(header.dim[axis + 1]);
    const int unit = header.units & 7;  // 1 metre, 2 millimetre, 3 micrometre, 0 unsaid
    affine *= unit == 1 ? 1000 : unit == 3 ? 0.001 : 1;
    affine.topRows<2>() *= -1;  // RAS to LPS
    set_axes(grid, affine.leftCols<3>());
    grid.origin = affine.col(3);
    return grid;
}

void check_dimensions(const NiftiHeader& header, const std::filesystem::path& path) {
    const auto axes = header.dim[0];
    bool good = axes >= 3 && axes <= 7;
    for (std::int64_t axis = 4; good && axis <= axes; ++axis) good = header.dim[axis] <= 1;
    if (!good)
        throw InvalidInput(
            {path.string(),
             fmt::format("has sizes {}", fmt::join(header.dim.begin() + 1, header.dim.end(), " ")),
             "3 dimensions", "export one three-dimensional volume"});
    check_size({header.dim[1], header.dim[2], header.dim[3]}, path);
}

template <typename Voxel>
std::vector<Voxel> read_voxels(NiftiStream& stream, std::size_t count, bool swapped) {
    std::vector<Voxel> voxels(count);
    stream.read(voxels.data(), count * sizeof(Voxel));
    if (swapped) swap_bytes(std::as_writable_bytes(std::span(voxels)), sizeof(Voxel));
    return voxels;
}

StoredVoxels read_voxels(NiftiStream& stream, const NiftiHeader& header, std::size_t count,
                         const std::filesystem::path& path) {
    switch (header.datatype) {
        case 2:
            return read_voxels<std::uint8_t>(stream, count, header.swapped);
        case 4:
            return read_voxels<std::int16_t>(stream, count, header.swapped);
        case 8:
            return read_voxels<std::int32_t>(stream, count, header.swapped);
        case 16:
            return read_voxels<float>(stream, count, header.swapped);
        case 64:
            return read_voxels<double>(stream, count, header.swapped);
        case 256:
            return read_voxels<std::int8_t>(stream, count, header.swapped);
        case 512:
            return read_voxels<std::uint16_t>(stream, count, header.swapped);
        case 768:
            return read_voxels<std::uint32_t>(stream, count, header.swapped);
        case 1024:
            return read_voxels<std::int64_t>(stream, count, header.swapped);
        case 1280:
            return read_voxels<std::uint64_t>(stream, count, header.swapped);
        default:
            throw InvalidInput({path.string(), fmt::format("has NIfTI datatype {}", header.datatype),
                                "integers or real numbers, no colours or complex numbers",
                                "export it as grey"});
    }
}

// 1 for a type that is none of those above.
std::size_t bytes_per_voxel(int datatype) {
    switch (datatype) {
        case 4:
        case 512:
            return 2;
        case 8:
        case 16:
        case 768:
            return 4;
        case 64:
        case 1024:
        case 1280:
            return 8;
        default:
            return 1;
    }
}

}  // namespace

StoredImage read_nifti(const std::filesystem::path& path, const NoteSink& note, const ReadOptions& options) {
    NiftiStream stream(path);
    const NiftiHeader header = read_nifti_header(stream, path);
    check_dimensions(header, path);
    StoredImage image;
    image.grid = grid_of(header, nifti_affine(header, path, note, options.nifti_frame));
    check_geometry(image.grid, path, note);
    if (const auto offset = static_cast<std::size_t>(std::max<std::int64_t>(header.voxel_offset, 0));
        offset > header.bytes) {
        if (offset > largest_header)
            throw InvalidInput({path.string(), fmt::format("claims a header of {} bytes", offset),
                                fmt::format("{} at most", largest_header), "check that the file is whole"});
        check_claim(offset, std::filesystem::file_size(path),
                    stream.packed() ? Packing::deflated : Packing::none, path);
        std::string extension(offset - header.bytes, '\0');
        stream.read(extension.data(), extension.size());
        image.labels = parse_xml_label_table(extension);
    }
    check_claim(image.grid.voxel_count() * bytes_per_voxel(header.datatype), std::filesystem::file_size(path),
                stream.packed() ? Packing::deflated : Packing::none, path);
    image.voxels = read_voxels(stream, header, image.grid.voxel_count(), path);
    stream.read_rest();
    if (std::isfinite(header.slope) && header.slope != 0) {
        image.slope = header.slope;
        image.intercept = std::isfinite(header.intercept) ? header.intercept : 0;
    }
    return image;
}

}  // namespace palpate::imaging
