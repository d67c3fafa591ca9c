// SPDX-License-Identifier: GPL-3.0-or-later
// For this folder only: the steps that reading volumes, label maps and DICOM share.
#pragma once
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <variant>
#include <vector>

#include "formats/model/errors.hpp"
#include "tools/imaging/files/image_files.hpp"

namespace palpate::imaging {

/// Voxels in the type that a file stores.
using StoredVoxels =
    std::variant<std::vector<std::uint8_t>, std::vector<std::int8_t>, std::vector<std::uint16_t>,
                 std::vector<std::int16_t>, std::vector<std::uint32_t>, std::vector<std::int32_t>,
                 std::vector<std::uint64_t>, std::vector<std::int64_t>, std::vector<float>,
                 std::vector<double>>;

/// One image as stored: a value is slope * voxel + intercept.
struct StoredImage {
    ImageGrid grid;
    std::size_t layers = 1;  ///< values per voxel, those of a voxel side by side
    StoredVoxels voxels;     ///< layers * voxel_count() of them, i fastest
    double slope = 1;
    double intercept = 0;
    std::map<std::string, std::string> header;  ///< the text fields of an NRRD header
    std::map<std::int32_t, Label> labels;       ///< of a label table in the header, by value
};

inline bool is_plain(const StoredImage& image) {
    return image.slope == 1 && image.intercept == 0;
}

/// The value of a voxel as a label: a whole number where it is one but for the slope's rounding to float32,
/// as NIfTI's of 1/255.
inline double label_value(const StoredImage& image, double voxel) {
    if (is_plain(image)) return voxel;
    const double value = image.slope * voxel + image.intercept, whole = std::round(value);
    return std::abs(value - whole) <= 0x1p-23 * std::abs(whole) ? whole : value;
}

/// Read one file's geometry (checked) and voxels; throw as read_volume() does, except for what the values
/// are.
StoredImage read_itk_image(const std::filesystem::path& path, const NoteSink& note);
StoredImage read_nifti(const std::filesystem::path& path, const NoteSink& note, const ReadOptions& options);
StoredImage read_vtk_image(const std::filesystem::path& path, const NoteSink& note);
StoredImage read_legacy_vtk(const std::filesystem::path& path, const NoteSink& note);
/// The one of the four that knows the format.
StoredImage read_image_file(const std::filesystem::path& path, const NoteSink& note,
                            const ReadOptions& options);

/// A DICOM series and what its headers say of its values.
struct DicomImage {
    Volume volume;
    std::string modality;     ///< as in SeriesSummary
    std::string stored_type;  ///< of its first file's voxels, "int16"
};

/// Reads a DICOM series of a folder or file; throws as read_volume() does, except for constant values.
DicomImage read_dicom(const std::filesystem::path& path, const NoteSink& note, const ReadOptions& options);

/// Turns what a file stores into what read_volume() and read_label_map() return; throw as these do.
Volume volume_from(StoredImage image, const std::filesystem::path& path);
LabelMap label_map_from(StoredImage image, const std::filesystem::path& path, const NoteSink& note,
                        Overlaps overlaps);

/// Throws InvalidInput unless a volume's values are finite and not all the same.
void check_values(const Volume& volume, const std::filesystem::path& path);

/// Tells whether a DICOM file says that it is a segmentation object.
bool is_dicom_segmentation(const std::filesystem::path& path);

/// Reads a DICOM segmentation object; throws as read_label_map() does, except for an empty map.
LabelMap read_dicom_segmentation(const std::filesystem::path& path, const NoteSink& note, Overlaps overlaps);

/// ASCII letters in lower case; header fields and file endings are compared so.
std::string in_lower_case(std::string text);

/// Text of a header as UTF-8: what is none is taken as Latin-1, and control characters become spaces.
std::string as_utf8(std::string_view text);

/// Checks sizes and spacings, and makes the directions orthonormal; throws InvalidInput naming `path`.
void check_geometry(ImageGrid& grid, const std::filesystem::path& path, const NoteSink& note);

/// Throws InvalidInput if nothing is at `path`, or what is neither file nor folder and may have no end, as a
/// pipe or a device, naming its kind.
void require_image_source(const std::filesystem::path& path);

/// Throws InvalidInput unless 2 ... 65535 voxels lie along each axis.
void check_size(const std::array<std::int64_t, 3>& size, const std::filesystem::path& path);

/// By how much a file may be smaller than its voxels: zlib shrinks by 1032 at most, and "0 " may be a double.
enum class Packing : std::uintmax_t { none = 1, text = 4, deflated = 1100 };

/// Throws InvalidInput if a header claims more bytes than a file of `held` bytes could hold, so that none can
/// make us allocate without end.
void check_claim(std::uintmax_t claimed, std::uintmax_t held, Packing packing,
                 const std::filesystem::path& path);

/// What to throw where memory does not suffice for a file.
InvalidInput beyond_memory(const std::filesystem::path& path);

/// A grid's spacing and direction from its voxel axes: columns are the steps of i, j, k in P, mm.
void set_axes(ImageGrid& grid, const Eigen::Matrix3d& axes);

}  // namespace palpate::imaging
