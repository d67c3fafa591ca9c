// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "formats/model/image_grid.hpp"
#include "formats/model/label_map.hpp"

namespace palpate::imaging {

/// Receives what a reader repaired or assumed, one sentence at a time, without text of the input's header or
/// path; may be empty.
using NoteSink = std::function<void(std::string_view)>;

/// What becomes of a voxel that two segments claim.
enum class Overlaps {
    refuse,
    later_wins,   ///< the segment that comes later in the file
    smaller_wins  ///< the segment of fewer voxels, the later one of two equals
};

/// Tells whether a file is DICOM by its preamble.
bool is_dicom(const std::filesystem::path& path);

/// Tells whether a file is NIfTI by its ending.
bool is_nifti(const std::filesystem::path& path);

/// What a caller decides where a file leaves it open.
struct ReadOptions {
    std::string series;                    ///< DICOM: number, UID or description as list_series() gives them
    bool show_descriptions = false;        ///< DICOM: in a refusal's list; they may identify a patient
    bool accept_gaps = false;              ///< DICOM: resample missing, uneven, doubled or tilted slices
    std::string nifti_frame;               ///< NIfTI: "qform" or "sform" where both are set and disagree
    Overlaps overlaps = Overlaps::refuse;  ///< label maps with segments in several layers
};

/// Reads NRRD (.nrrd, .nhdr), MetaImage (.mha, .mhd), NIfTI-1 and -2 (.nii, .nii.gz), VTK image data (.vti,
/// .vtk), a DICOM file of several frames or a folder of DICOM slices, in which what is no image is skipped
/// with a note. CT comes in HU, by each slice's own slope and intercept.
/// Frames: NIfTI is RAS and becomes LPS; the others are LPS unless their header says otherwise, and a note
/// says so where the header says nothing. Direction cosines off orthonormality by at most 1e-3 are replaced
/// by the nearest rotation, with a note. Of several DICOM series one is read without options.series only if
/// each other one is a localizer or has at most a fifth of its slices; a note says so. Two NIfTI transforms
/// agree within a tenth of a voxel. With accept_gaps, slices are interpolated linearly onto an even, untilted
/// grid between the first and the last one, with a note; doubled slices must then be identical. Throws
/// InvalidInput if the file is missing, damaged, not three-dimensional, not grey, holds one value only, holds
/// NaN or infinity, claims more voxels than it could hold, keeps a MetaImage's voxels in several files, has
/// NRRD units other than mm, a spacing that is not positive, directions further off, transforms that disagree
/// (with both), several series (with the list), or slices that are missing, doubled, unevenly spaced, of
/// mixed sizes or directions, or sheared (with the place). Cost: one pass over the voxels; memory for the
/// voxels as stored and in float32.
Volume read_volume(const std::filesystem::path& path, const NoteSink& note = {},
                   const ReadOptions& options = {});

/// One DICOM series as a list shows it. Description and UID may identify a patient: not for outputs.
struct SeriesSummary {
    std::string number;       ///< its DICOM number where all have distinct ones, else its place in the list
    std::string modality;     ///< "CT", "MR", ...
    std::string description;  ///< may be empty
    std::string uid;          ///< may be empty
    std::array<std::int32_t, 3> size{0, 0, 0};          ///< columns, rows, slices
    Eigen::Vector3d spacing = Eigen::Vector3d::Zero();  ///< mm; 0 where unknown
    bool localizer = false;
};

/// Lists the image series of a DICOM folder or file, by number. Throws InvalidInput if there is none. Cost:
/// it reads every file's header.
std::vector<SeriesSummary> list_series(const std::filesystem::path& path, const NoteSink& note = {});

/// One slice of a DICOM series and where it lies.
struct PlacedSlice {
    std::string file;
    std::size_t frame = 0;   ///< of the file, from 0
    Eigen::Vector3d origin;  ///< p_P of its first voxel, mm
};

/// The slices of a DICOM series by place, ascending along k, and the grid of them all; its spacing along k is
/// the mean one.
struct PlacedSeries {
    ImageGrid grid;
    std::vector<PlacedSlice> slices;
};

/// Reads where the slices of a DICOM series lie, without their pixels; chooses and throws as read_volume()
/// does, but gaps are no fault. Cost: it reads every file's header.
PlacedSeries read_dicom_places(const std::filesystem::path& path, const NoteSink& note = {},
                               const ReadOptions& options = {});

/// Reads a label map in any format of read_volume(), or DICOM SEG instead of grey DICOM, as integers. Names
/// and colours come from SegmentN_* fields of an NRRD header, from a DICOM SEG's segments, or from the label
/// table in a NIfTI header extension as TotalSegmentator and Connectome Workbench write it; a value without
/// one is named "label_<value>". Only values that occur are listed; equal names get a number.
/// Segments in several layers become one map; where they overlap, options.overlaps decides. Throws as
/// read_volume() does, and InvalidInput if a value is not an integer of 0 ... 65535, if all voxels are
/// background, or if segments overlap and the option is to refuse (with the pairs).
LabelMap read_label_map(const std::filesystem::path& path, const NoteSink& note = {},
                        const ReadOptions& options = {});

/// What a caller takes an image for.
enum class ImageKind { found_out, volume, labels };

/// An image as what it is, and what else its file tells.
struct FoundImage {
    std::variant<Volume, LabelMap> image;
    std::string told_by;      ///< why it counts as that, one clause for people
    std::string stored_type;  ///< of its voxels: "int16"; "binary" for DICOM SEG
    std::string modality;     ///< as in SeriesSummary; empty for what is no DICOM
};

/// Reads a volume or a label map, whichever the file holds unless `kind` says. Labels are a DICOM SEG, what
/// names segments or labels in its header, and whole numbers of which seven in ten lie beside one of their
/// own. Throws as read_volume() and read_label_map() do. Cost: the one's or the other's.
FoundImage read_image(const std::filesystem::path& path, ImageKind kind = ImageKind::found_out,
                      const NoteSink& note = {}, const ReadOptions& options = {});

/// Throws InvalidInput naming `culprit` for a map of more than 1300 labels: the header that write_label_map()
/// would write has more lines than NRRD readers take in an acceptable time, ours too.
void require_few_labels(const LabelMap& map, const std::string& culprit);

/// Throws InvalidInput unless the name of an output has the ending by which others will know what it is.
void require_ending(const std::filesystem::path& output, std::string_view ending);

/// Writes gzip-compressed NRRD (".nrrd") in LPS, as int16 if every value is an integer that fits, else as
/// float32. Nothing but geometry and values is written. Throws SystemFailure if the file could not be written
/// whole.
void write_volume(const std::filesystem::path& path, const Volume& volume);

/// Writes a .seg.nrrd that 3D Slicer opens as a segmentation, one layer, uint8 or uint16. Nothing but
/// geometry, values, names and colours is written. Throws as write_volume() and require_few_labels() do.
void write_label_map(const std::filesystem::path& path, const LabelMap& map);

/// Writes gzip-compressed NIfTI-1, uint8 or uint16, whose RAS affine is the grid's LPS one turned about z.
/// Nothing but geometry, in float32, and values is written: names go into a bids_label_table(). ITK wants
/// a path that ends in ".nii.gz". Throws as write_volume() does.
void write_nifti_labels(const std::filesystem::path& path, const LabelMap& map);

/// Limits the threads that imaging functions use; results do not depend on it.
void set_imaging_threads(int count);

}  // namespace palpate::imaging
