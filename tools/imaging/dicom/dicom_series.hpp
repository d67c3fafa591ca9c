// SPDX-License-Identifier: GPL-3.0-or-later
// For this folder only: what a DICOM folder holds.
#pragma once
#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "tools/imaging/files/image_files.hpp"

namespace palpate::imaging {

/// Integers of `stored` bits in `allocated` ones, up to bit `high`.
struct DicomPixelFormat {
    int allocated = 16, stored = 16, high = 15;
    bool has_sign = false;
    int samples = 1;  ///< values of a pixel
};

/// One slice: a file, or a frame of a file with several.
struct DicomSlice {
    std::string file;
    std::size_t frame = 0;
    std::optional<Eigen::Vector3d> origin;                  ///< p_P of the first voxel
    std::optional<Eigen::Matrix<double, 3, 2>> directions;  ///< of growing column and row index, in P
    std::optional<Eigen::Vector2d> spacing;                 ///< between columns and between rows, mm
    std::array<std::int32_t, 2> size{0, 0};                 ///< columns, rows
    DicomPixelFormat format;
    double slope = 1;
    double intercept = 0;
};

struct DicomSeries {
    SeriesSummary summary;
    std::string colours;  ///< photometric interpretation if it is not grey, else empty
    std::vector<DicomSlice> slices;
};

/// Reads the headers of a file or of all files below a folder; files that are no images are counted in a
/// note. Series are in the order of their numbers. Throws InvalidInput if there is no image.
std::vector<DicomSeries> scan_dicom(const std::filesystem::path& path, const NoteSink& note);

/// Sorts series and numbers them: by DICOM number if all have one of their own, else by place.
void number_series(std::vector<DicomSeries>& all);

/// The series that `options` names, or the one that is meant where none is named, as read_volume() says;
/// throws InvalidInput with the list.
const DicomSeries& choose_series(const std::vector<DicomSeries>& all, const ReadOptions& options,
                                 const std::filesystem::path& path, const NoteSink& note);

}  // namespace palpate::imaging
