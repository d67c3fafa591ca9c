// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <functional>
#include <string_view>

#include "formats/model/image_grid.hpp"
#include "formats/model/label_map.hpp"

namespace palpate {

/// Receives what a reader repaired or assumed, one sentence at a time; may be empty.
using NoteSink = std::function<void(std::string_view)>;

/// Reads NRRD (.nrrd, .nhdr), MetaImage (.mha, .mhd), NIfTI (.nii, .nii.gz) or a folder of DICOM slices.
/// Of several DICOM series in a folder the one with most slices is read, with a note. RAS files become LPS.
/// Direction cosines off orthonormality by at most 1e-3 are replaced by the nearest rotation, with a note.
/// Throws InvalidInput if the file is missing, damaged, not three-dimensional, holds one value only, holds
/// NaN or infinity, has a spacing that is not positive, directions further off, or slices that are missing,
/// doubled, unevenly spaced or sheared (with the place).
Volume read_volume(const std::filesystem::path& path, const NoteSink& note = {});

/// Writes gzip-compressed NRRD in LPS, as int16 if every value is an integer that fits, else as float32.
/// Nothing but geometry and values is written. The path must end in ".nrrd".
/// Throws InvalidInput for another ending, SystemFailure if the file could not be written whole.
void write_volume(const std::filesystem::path& path, const Volume& volume);

/// Reads a label map in any format of read_volume() but DICOM. Names and colours come from a .seg.nrrd
/// header (SegmentN_Name, SegmentN_LabelValue, SegmentN_Color); a value without one is named "label_<value>".
/// Only values that occur are listed. Throws as read_volume() does, and InvalidInput if a value is not an
/// integer of 0 ... 65535, if all voxels are background, or if segments overlap (several layers).
LabelMap read_label_map(const std::filesystem::path& path, const NoteSink& note = {});

/// Writes a .seg.nrrd that 3D Slicer opens as a segmentation, one layer, uint8 or uint16. Nothing but
/// geometry, values, names and colours is written. The path must end in ".seg.nrrd". Throws as
/// write_volume() does.
void write_label_map(const std::filesystem::path& path, const LabelMap& map);

/// Limits the threads that imaging functions use; results do not depend on it.
void set_imaging_threads(int count);

}  // namespace palpate
