// SPDX-License-Identifier: GPL-3.0-or-later
// For this folder only: the steps that reading volumes, label maps and DICOM folders share.
#pragma once
#include <filesystem>
#include <map>
#include <string>

#include "tools/imaging/image_files.hpp"

namespace palpate {

/// Voxels as stored, and the text fields of an NRRD header (empty for other formats).
struct ReadImage {
    Volume volume;
    std::map<std::string, std::string> header;
};

/// Reads one NRRD, MetaImage or NIfTI file; throws as read_volume() does, except for constant values.
ReadImage read_image_file(const std::filesystem::path& path, const NoteSink& note);

/// Reads the DICOM series in a folder; throws as read_volume() does, except for constant values.
Volume read_dicom_folder(const std::filesystem::path& folder, const NoteSink& note);

/// Checks sizes and spacings, and makes the directions orthonormal; throws InvalidInput naming `path`.
void check_geometry(ImageGrid& grid, const std::filesystem::path& path, const NoteSink& note);

/// Throws InvalidInput naming the first voxel that is NaN or infinite.
void check_finite(const Volume& volume, const std::filesystem::path& path);

}  // namespace palpate
