// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace palpate::imaging {

struct DicomValue;

/// Values of a DICOM file or of an item in it, by tag: group * 65536 + element. Of a tag that stands twice
/// the first one counts.
struct DicomSet {
    std::map<std::uint32_t, DicomValue> values;
};

/// A value: its bytes, or the items of a sequence.
struct DicomValue {
    std::string bytes;
    bool big_endian = false;
    std::vector<DicomSet> items = {};
};

/// A number of two bytes; 0 if it is missing.
std::uint16_t unsigned_short(const DicomSet& set, std::uint32_t tag);

/// Follows a DICOM file's elements (PS3.5 chapter 7, PS3.10) from its first to its last byte, nested ones
/// too, before GDCM or DCMTK sees it. Throws InvalidInput unless every element and item is of a kind that can
/// be, and within what holds it, sequences end as they say, none lies deeper than 32 others, and native
/// pixels are as many as rows, columns, frames and bits claim. Odd lengths, types of two capitals that are
/// not known and zeros behind the last element are let pass, as scanners and archives make them. A file
/// without preamble must begin with an element of group 2 or 8. Deflated files unpack to 1100 times their
/// size at most. Cost: three short reads an element, none of values.
void require_sound_dicom(const std::filesystem::path& path);

/// Reads the values of the groups 0008, 0020, 0028 and 5200, of which those of more than 4 KiB are left out;
/// throws as require_sound_dicom() does.
DicomSet read_dicom_header(const std::filesystem::path& path);

/// The bytes of a file's pixels.
struct DicomPixels {
    std::string syntax;       ///< UID of the transfer syntax; empty if none is told
    bool compressed = false;  ///< whether by fragments
    bool big_endian = false;
    std::string offsets;             ///< the table of offsets of frames, as it stands there
    std::vector<std::string> parts;  ///< the fragments, or all pixels in one; empty if there are none
};

/// Reads the bytes of a file's pixels; throws as require_sound_dicom() does.
DicomPixels read_dicom_pixels(const std::filesystem::path& path);

}  // namespace palpate::imaging
