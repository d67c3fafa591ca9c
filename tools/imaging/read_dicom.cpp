// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <algorithm>
#include <fmt/format.h>
#include <gdcmTrace.h>
#include <itkGDCMImageIO.h>
#include <itkGDCMSeriesFileNames.h>
#include <itkImageSeriesReader.h>

#include "formats/model/errors.hpp"
#include "tools/imaging/itk_image.hpp"
#include "tools/imaging/read_image.hpp"

namespace palpate {
namespace {

struct Slice {
    std::string file;
    Eigen::Vector3d origin;  // p_P of the first voxel
    double position;         // along the slice normal, mm
};

std::vector<std::string> largest_series(const std::filesystem::path& folder, const NoteSink& note) {
    auto names = itk::GDCMSeriesFileNames::New();
    names->SetRecursive(true);
    names->SetDirectory(folder.string());
    const std::vector<std::string> series = names->GetSeriesUIDs();
    std::vector<std::string> largest;
    for (const std::string& uid : series)
        if (auto files = names->GetFileNames(uid); files.size() > largest.size()) largest = std::move(files);
    if (largest.empty())
        throw InvalidInput({folder.string(), "holds no DICOM image series", "",
                            "name the folder that holds the slices, or a NRRD, MetaImage or NIfTI file"});
    if (note && series.size() > 1)
        note(fmt::format("the folder holds {} series; reading the largest, {} slices", series.size(),
                         largest.size()));
    return largest;
}

// The series' grid with the depth still open, from its first file.
ImageGrid plane_of(const std::string& file) {
    auto io = itk::GDCMImageIO::New();
    io->SetFileName(file);
    io->ReadImageInformation();
    ImageGrid grid;
    for (unsigned axis = 0; axis < 2; ++axis) {
        grid.size[axis] = static_cast<std::int32_t>(io->GetDimensions(axis));
        grid.spacing[axis] = io->GetSpacing(axis);
        const std::vector<double> direction = io->GetDirection(axis);
        for (unsigned row = 0; row < 3; ++row) grid.direction(row, axis) = direction[row];
    }
    grid.direction.col(2) = grid.direction.col(0).cross(grid.direction.col(1));
    return grid;
}

std::vector<Slice> sorted_slices(const std::vector<std::string>& files, const ImageGrid& plane,
                                 const std::filesystem::path& folder) {
    std::vector<Slice> slices;
    for (const std::string& file : files) {
        auto io = itk::GDCMImageIO::New();
        io->SetFileName(file);
        io->ReadImageInformation();
        const auto differs = [&](const std::string& what) {
            return InvalidInput({folder.string(),
                                 what + " of " + std::filesystem::path(file).filename().string() +
                                     " differs from the other slices",
                                 "", "keep the files of one series only"});
        };
        Slice slice{file, Eigen::Vector3d(io->GetOrigin(0), io->GetOrigin(1), io->GetOrigin(2)), 0};
        for (unsigned axis = 0; axis < 2; ++axis) {
            if (static_cast<std::int32_t>(io->GetDimensions(axis)) != plane.size[axis]) throw differs("size");
            if (std::abs(io->GetSpacing(axis) - plane.spacing[axis]) > 1e-4) throw differs("spacing");
            const std::vector<double> direction = io->GetDirection(axis);
            const Eigen::Vector3d column(direction[0], direction[1], direction[2]);
            if ((column - plane.direction.col(axis)).norm() > 1e-3) throw differs("direction");
        }
        slice.position = plane.direction.col(2).dot(slice.origin);
        slices.push_back(std::move(slice));
    }
    std::ranges::sort(slices, {}, [](const Slice& slice) { return std::pair(slice.position, slice.file); });
    return slices;
}

// Distance from each slice to the next, which must be the same everywhere; a missing slice doubles it.
double even_gap(const std::vector<Slice>& slices, const ImageGrid& plane,
                const std::filesystem::path& folder) {
    const double mean =
        (slices.back().position - slices.front().position) / static_cast<double>(slices.size() - 1);
    std::vector<double> gaps;
    for (std::size_t i = 1; i < slices.size(); ++i)
        gaps.push_back(slices[i].position - slices[i - 1].position);
    std::vector<double> ordered = gaps;
    std::ranges::sort(ordered);
    const double usual = ordered[ordered.size() / 2];
    for (std::size_t i = 0; i < gaps.size(); ++i) {
        const Eigen::Vector3d step = slices[i + 1].origin - slices[i].origin;
        const auto at = fmt::format("between the slices at {:.2f} and {:.2f} mm along the normal",
                                    slices[i].position, slices[i + 1].position);
        if (gaps[i] < 1e-3)
            throw InvalidInput({folder.string(), "two slices lie at one place, " + at, "one slice per place",
                                "keep one phase or reconstruction of the series"});
        // 2 % of a slice distance: above what positions rounded to 0.01 mm show, far below a missing slice.
        if (std::abs(gaps[i] - usual) > std::max(0.02 * usual, 0.011))
            throw InvalidInput({folder.string(), fmt::format("{:.3f} mm {}", gaps[i], at),
                                fmt::format("{:.3f} mm as elsewhere", usual),
                                "add the missing slices or resample the series evenly"});
        if ((step - gaps[i] * plane.direction.col(2)).norm() > 0.02 * usual)
            throw InvalidInput({folder.string(), "slices are shifted sideways (tilted gantry) " + at,
                                "slices stacked along their normal", "resample the series first"});
    }
    return mean;
}

}  // namespace

Volume read_dicom_folder(const std::filesystem::path& folder, const NoteSink& note) {
    // GDCM prints what it meets in files that belong to no image series; faults of the series are thrown
    // below.
    gdcm::Trace::ErrorOff();
    gdcm::Trace::WarningOff();
    const std::vector<std::string> files = largest_series(folder, note);
    if (files.size() < 2)
        throw InvalidInput({folder.string(), "holds a single DICOM slice", "a series of 2 slices or more",
                            "name the folder that holds the whole series"});
    try {
        Volume volume;
        volume.grid = plane_of(files.front());
        const std::vector<Slice> slices = sorted_slices(files, volume.grid, folder);
        volume.grid.size[2] = static_cast<std::int32_t>(slices.size());
        volume.grid.origin = slices.front().origin;
        volume.grid.spacing[2] = even_gap(slices, volume.grid, folder);
        check_geometry(volume.grid, folder, note);

        std::vector<std::string> ordered;
        for (const Slice& slice : slices) ordered.push_back(slice.file);
        auto reader = itk::ImageSeriesReader<ItkImage<float>>::New();
        reader->SetImageIO(itk::GDCMImageIO::New());
        reader->SetFileNames(ordered);
        reader->Update();
        const auto voxels = voxels_of(*reader->GetOutput());
        if (voxels.size() != volume.grid.voxel_count())
            throw InvalidInput({folder.string(), "slices hold several frames", "one frame per file",
                                "convert with dcm2niix first"});
        volume.values.assign(voxels.begin(), voxels.end());
        return volume;
    } catch (const itk::ExceptionObject& error) {
        throw InvalidInput({folder.string(), "cannot be read: " + reason_of(error), "",
                            "check that all files of the series are whole"});
    }
}

}  // namespace palpate
