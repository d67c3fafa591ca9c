// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/imaging/files/read_image.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <itkMultiThreaderBase.h>
#include <itkObject.h>

#include "formats/model/errors.hpp"
#include "formats/model/reading/small_file.hpp"
#include "formats/model/reading/utf8.hpp"

namespace palpate::imaging {
namespace {

// Directions nearer to orthonormal than this differ by header round-off only.
constexpr double round_off_tolerance = 1e-6;
constexpr double repair_tolerance = 1e-3;

// Nothing of what is no file, as of a pipe, whose bytes may never come.
std::string first_bytes(const std::filesystem::path& path, std::size_t count) {
    if (!palpate::other_kind(path).empty()) return {};
    std::string bytes(count, '\0');
    std::ifstream stream(path, std::ios::binary);
    stream.read(bytes.data(), static_cast<std::streamsize>(count));
    bytes.resize(stream.gcount());
    return bytes;
}

std::vector<float> float_values(StoredImage& image) {
    if (auto* values = std::get_if<std::vector<float>>(&image.voxels);
        values != nullptr && image.slope == 1 && image.intercept == 0)
        return std::move(*values);
    return std::visit(
        [&](const auto& stored) {
            std::vector<float> values(stored.size());
            std::ranges::transform(stored, values.begin(), [&](auto value) {
                return static_cast<float>(image.slope * static_cast<double>(value) + image.intercept);
            });
            return values;
        },
        image.voxels);
}

}  // namespace

std::string in_lower_case(std::string text) {
    for (char& c : text)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return text;
}

std::string as_utf8(std::string_view text) {
    const bool good = is_utf8(text);
    std::string result;
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        if (byte < 32 || byte == 127)
            result += ' ';
        else if (byte < 128 || good)
            result += c;
        else
            result.append({static_cast<char>(0xC0U | byte >> 6), static_cast<char>(0x80U | (byte & 0x3FU))});
    }
    return result;
}

bool is_dicom(const std::filesystem::path& path) {
    return first_bytes(path, 132).ends_with("DICM");
}

bool is_nifti(const std::filesystem::path& path) {
    const std::string name = in_lower_case(path.filename().string());
    return name.ends_with(".nii") || name.ends_with(".nii.gz");
}

void require_image_source(const std::filesystem::path& path) {
    std::error_code none;
    if (!std::filesystem::exists(path, none))
        throw InvalidInput({path.string(), "no such file or folder", "", "check the path"});
    if (const std::string kind = palpate::other_kind(path);
        !kind.empty() && !std::filesystem::is_directory(path, none))
        throw InvalidInput({path.string(), kind, "a file or a folder of DICOM slices", "check the path"});
}

void check_size(const std::array<std::int64_t, 3>& size, const std::filesystem::path& path) {
    for (const std::int64_t count : size) {
        if (count > 65535)
            throw InvalidInput({path.string(), fmt::format("claims {} voxels along one axis", count),
                                "65535 at most", "check that the file is whole"});
        if (count < 2)
            throw InvalidInput({path.string(),
                                fmt::format("is flat: {} x {} x {} voxels", size[0], size[1], size[2]),
                                "2 voxels or more along each axis", "choose a three-dimensional volume"});
    }
}

void check_claim(std::uintmax_t claimed, std::uintmax_t held, Packing packing,
                 const std::filesystem::path& path) {
    if (claimed / static_cast<std::uintmax_t>(packing) > held)
        throw InvalidInput(
            {path.string(), "holds fewer voxels than its header claims", "", "check that the file is whole"});
}

InvalidInput beyond_memory(const std::filesystem::path& path) {
    return InvalidInput({path.string(), "needs more memory than there is", "",
                         "crop the volume, or read it on a machine with more memory"});
}

void set_axes(ImageGrid& grid, const Eigen::Matrix3d& axes) {
    grid.spacing = axes.colwise().norm();
    grid.direction = axes * grid.spacing.cwiseInverse().asDiagonal();
    grid.direction.array() += 0.0;  // no negative zeros
}

void check_geometry(ImageGrid& grid, const std::filesystem::path& path, const NoteSink& note) {
    check_size({grid.size[0], grid.size[1], grid.size[2]}, path);
    if (!(grid.spacing.minCoeff() > 0) || !grid.spacing.allFinite() || !grid.origin.allFinite())
        throw InvalidInput(
            {path.string(),
             fmt::format("has spacing {} x {} x {} mm", grid.spacing[0], grid.spacing[1], grid.spacing[2]),
             "finite positive numbers", "correct the header"});
    const Eigen::Matrix3d product = grid.direction.transpose() * grid.direction;
    const double deviation = (product - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
    if (!(deviation <= repair_tolerance))
        throw InvalidInput({path.string(), fmt::format("has directions {:.2g} off orthonormality", deviation),
                            fmt::format("{} at most", repair_tolerance),
                            "resample the volume onto a rectangular grid"});
    if (deviation <= round_off_tolerance) return;
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(grid.direction, Eigen::ComputeFullU | Eigen::ComputeFullV);
    grid.direction = svd.matrixU() * svd.matrixV().transpose();
    if (note)
        note(fmt::format("directions were {:.2g} off orthonormality and were made orthonormal", deviation));
}

void check_values(const Volume& volume, const std::filesystem::path& path) {
    const auto bad = std::ranges::find_if(volume.values, [](float value) { return !std::isfinite(value); });
    if (bad == volume.values.end()) {
        const auto [low, high] = std::ranges::minmax(volume.values);
        if (low == high)
            throw InvalidInput({path.string(), fmt::format("is empty: every voxel is {}", low), "",
                                "choose another file or export it again"});
        return;
    }
    const auto& size = volume.grid.size;
    const auto offset = bad - volume.values.begin();
    throw InvalidInput({path.string(),
                        fmt::format("voxel ({}, {}, {}) is {}", offset % size[0], offset / size[0] % size[1],
                                    offset / size[0] / size[1], *bad),
                        "finite values", "replace such voxels, by -1024 HU in CT"});
}

Volume volume_from(StoredImage image, const std::filesystem::path& path) {
    if (image.layers != 1)
        throw InvalidInput({path.string(), fmt::format("has {} values per voxel", image.layers), "1",
                            "export one scalar volume, or read a label map with layers as labels"});
    Volume volume{image.grid, float_values(image)};
    check_values(volume, path);
    return volume;
}

StoredImage read_image_file(const std::filesystem::path& path, const NoteSink& note,
                            const ReadOptions& options) {
    const std::string name = in_lower_case(path.filename().string());
    if (is_nifti(path)) return read_nifti(path, note, options);
    if (name.ends_with(".vti")) return read_vtk_image(path, note);
    if (name.ends_with(".vtk") && first_bytes(path, 5) == "# vtk") return read_legacy_vtk(path, note);
    return read_itk_image(path, note);
}

Volume read_volume(const std::filesystem::path& path, const NoteSink& note, const ReadOptions& options) {
    itk::Object::GlobalWarningDisplayOff();
    require_image_source(path);
    try {
        if (std::error_code none; !std::filesystem::is_directory(path, none) && !is_dicom(path))
            return volume_from(read_image_file(path, note, options), path);
        DicomImage image = read_dicom(path, note, options);
        check_values(image.volume, path);
        return std::move(image.volume);
    } catch (const std::bad_alloc&) {
        throw beyond_memory(path);
    }
}

void set_imaging_threads(int count) {
    itk::MultiThreaderBase::SetGlobalDefaultNumberOfThreads(static_cast<itk::ThreadIdType>(count));
}

}  // namespace palpate::imaging
