// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <fmt/format.h>
#include <set>

#include "formats/model/errors.hpp"
#include "tools/imaging/dicom/dicom_pixels.hpp"
#include "tools/imaging/dicom/dicom_series.hpp"
#include "tools/imaging/dicom/dicom_stack.hpp"
#include "tools/imaging/files/read_image.hpp"

namespace palpate::imaging {
namespace {

std::string name_of(const DicomSlice& slice) {
    const std::string name = std::filesystem::path(slice.file).filename().string();
    return slice.frame == 0 ? name : fmt::format("{} frame {}", name, slice.frame + 1);
}

template <typename Stored>
void rescale(const char* stored, const DicomSlice& slice, std::span<float> values) {
    for (std::size_t i = 0; i < values.size(); ++i) {
        Stored value;
        std::memcpy(&value, stored + i * sizeof(Stored), sizeof(Stored));
        values[i] = static_cast<float>(slice.slope * static_cast<double>(value) + slice.intercept);
    }
}

void rescale(const char* stored, const DicomSlice& slice, std::span<float> values) {
    const bool has_sign = slice.format.has_sign;
    switch (slice.format.allocated) {
        case 8:
            return has_sign ? rescale<std::int8_t>(stored, slice, values)
                            : rescale<std::uint8_t>(stored, slice, values);
        case 16:
            return has_sign ? rescale<std::int16_t>(stored, slice, values)
                            : rescale<std::uint16_t>(stored, slice, values);
        default:
            return has_sign ? rescale<std::int32_t>(stored, slice, values)
                            : rescale<std::uint32_t>(stored, slice, values);
    }
}

// The pixels of one file's slices, each to its place in the stack; returns their type.
std::string read_pixels(const std::string& file, std::span<const DicomSlice> slices, const ImageGrid& grid,
                        std::span<float> values) {
    const auto first = std::ranges::find(slices, file, &DicomSlice::file);
    const auto frames = static_cast<std::size_t>(std::ranges::count(slices, file, &DicomSlice::file));
    const std::vector<char> stored = stored_values(*first, frames);
    const std::size_t count = static_cast<std::size_t>(grid.size[0]) * static_cast<std::size_t>(grid.size[1]);
    for (std::size_t k = 0; k < slices.size(); ++k)
        if (slices[k].file == file)
            rescale(stored.data() + slices[k].frame * (stored.size() / frames), slices[k],
                    values.subspan(k * count, count));
    return type_of(first->format);
}

void require_one_plane(const DicomSeries& series, const std::filesystem::path& path) {
    const DicomSlice& first = series.slices.front();
    if (!series.colours.empty())
        throw InvalidInput({path.string(), "holds colours (" + series.colours + ")", "grey values",
                            "choose the original series, not a rendering of it"});
    for (const DicomSlice& slice : series.slices) {
        if (!slice.origin || !slice.directions || !slice.spacing)
            throw InvalidInput({path.string(), name_of(slice) + " says not where its pixels lie",
                                "ImagePositionPatient, ImageOrientationPatient and PixelSpacing",
                                "choose a series of CT or MR slices"});
        const auto differs = [&](const std::string& what) {
            return InvalidInput({path.string(),
                                 what + " of " + name_of(slice) + " differs from " + name_of(first),
                                 "slices of one size, spacing and direction",
                                 "keep the files of one acquisition in a folder of their own"});
        };
        if (slice.size != first.size) throw differs("size");
        if ((*slice.spacing - *first.spacing).cwiseAbs().maxCoeff() > 1e-4) throw differs("spacing");
        if ((*slice.directions - *first.directions).colwise().norm().maxCoeff() > 1e-3)
            throw differs("direction");
    }
}

// The chosen series.
struct OrderedSeries {
    std::vector<DicomSlice> slices;  // in order of place
    ImageGrid grid;                  // but for the distance of slices
    std::string modality;
};

OrderedSeries ordered_series(const std::filesystem::path& path, const NoteSink& note,
                             const ReadOptions& options) {
    const std::vector<DicomSeries> all = scan_dicom(path, note);
    DicomSeries series = choose_series(all, options, path, note);
    if (series.slices.size() < 2)
        throw InvalidInput({path.string(), "holds a single DICOM slice", "a series of 2 slices or more",
                            "name the folder that holds the whole series"});
    require_one_plane(series, path);
    const DicomSlice& first = series.slices.front();
    ImageGrid grid;
    grid.size = {first.size[0], first.size[1], static_cast<std::int32_t>(series.slices.size())};
    grid.spacing.head<2>() = *first.spacing;
    grid.direction.leftCols<2>() = *first.directions;
    grid.direction.col(2) = grid.direction.col(0).cross(grid.direction.col(1));
    check_geometry(grid, path, note);
    const Eigen::Vector3d normal = grid.direction.col(2);
    std::ranges::stable_sort(series.slices, {}, [&](const DicomSlice& s) { return normal.dot(*s.origin); });
    grid.origin = *series.slices.front().origin;
    return {std::move(series.slices), grid, series.summary.modality};
}

}  // namespace

PlacedSeries read_dicom_places(const std::filesystem::path& path, const NoteSink& note,
                               const ReadOptions& options) {
    auto [slices, grid, modality] = ordered_series(path, note, options);
    const double length = grid.direction.col(2).dot(*slices.back().origin - grid.origin);
    if (length > 0) grid.spacing[2] = length / static_cast<double>(slices.size() - 1);
    PlacedSeries series{grid, {}};
    for (const DicomSlice& slice : slices) series.slices.push_back({slice.file, slice.frame, *slice.origin});
    return series;
}

DicomImage read_dicom(const std::filesystem::path& path, const NoteSink& note, const ReadOptions& options) {
    const auto [slices, ordered_grid, modality] = ordered_series(path, note, options);
    if (note && modality != "CT")
        note(fmt::format("modality {}: values are not HU", modality.empty() ? "unknown" : modality));
    DicomImage image{.volume = {ordered_grid, {}}, .modality = modality, .stored_type = ""};
    Volume& volume = image.volume;
    ImageGrid& grid = volume.grid;
    const Eigen::Vector3d normal = grid.direction.col(2);
    std::vector<SlicePlace> places;
    for (const DicomSlice& slice : slices) places.push_back({*slice.origin, name_of(slice)});
    const StackFault fault = find_stack_fault(places, normal, grid.spacing.head<2>().minCoeff());
    if (!fault.found.empty() && !options.accept_gaps)
        throw InvalidInput({path.string(), fault.found, fault.expected,
                            fault.next_step + ", or interpolate with 'palpate import ... --accept-gaps'"});
    grid.spacing[2] = fault.mean_gap > 0 ? fault.mean_gap : 1;

    std::set<std::string> files;
    for (const DicomSlice& slice : slices) files.insert(slice.file);
    std::uintmax_t bytes = 0;
    for (const std::string& file : files) bytes += std::filesystem::file_size(file);
    check_claim(grid.voxel_count(), bytes, Packing::deflated, path);
    volume.values.resize(grid.voxel_count());
    for (const std::string& file : files) {
        const std::string type = read_pixels(file, slices, grid, volume.values);
        if (image.stored_type.empty()) image.stored_type = type;
    }
    if (!fault.found.empty()) volume = resample_stack(volume, places, path, note);
    return image;
}

}  // namespace palpate::imaging
