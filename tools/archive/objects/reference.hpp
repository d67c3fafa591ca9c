// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "tools/imaging/files/image_files.hpp"

namespace palpate::archive {

/// A slice that an object refers to.
struct ReferenceSlice {
    std::string sop_class, sop_instance;       ///< UIDs
    int frame = 0;                             ///< of a file of several, from 1; 0: the file has one
    Eigen::Vector3d origin = {0.0, 0.0, 0.0};  ///< p_P of its first voxel, mm
};

/// The series that a result was made from.
struct Reference {
    std::string study_uid, series_uid, frame_of_reference_uid;
    ImageGrid grid;                      ///< spacing along k is the mean one
    std::vector<ReferenceSlice> slices;  ///< ascending along k
    /// Values of patient and study by group and element, UTF-8.
    std::map<std::pair<std::uint16_t, std::uint16_t>, std::string> identity;
};

/// Reads what an object has to say of a DICOM series so that an archive files it beside it. Throws
/// InvalidInput if the folder holds no DICOM image series, several (with the list), or if it lacks the UIDs
/// of study, series or instance.
Reference read_reference(const std::filesystem::path& path, const imaging::ReadOptions& options,
                         const imaging::NoteSink& note);

/// Throws InvalidInput unless a label map's grid lies on the reference's slices: the same columns and rows
/// within a twentieth of a pixel, slices parallel to and between the first and the last one.
void require_fit(const ImageGrid& labels, const Reference& reference, const std::string& culprit);

/// Throws InvalidInput if points, such as a surface's vertices, reach more than a slice beyond the
/// reference's voxels.
void require_inside(const std::vector<Eigen::Vector3d>& points_P, const Reference& reference,
                    const std::string& culprit);

}  // namespace palpate::archive
