// SPDX-License-Identifier: GPL-3.0-or-later
// For this folder only: the pixels of one DICOM file.
#pragma once
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "tools/imaging/dicom/dicom_series.hpp"

namespace palpate::imaging {

/// The values of all frames of a file, one after the other, as stored, in the machine's byte order: signed or
/// unsigned integers of 8, 16 or 32 bits, see type_of(). Unused bits are gone, the sign reaches the highest.
/// Compressed frames are decoded by GDCM, after a look at the heads of their codes. Throws InvalidInput if
/// there are fewer pixels than `slice` and `frames` say, or they cannot be decoded.
std::vector<char> stored_values(const DicomSlice& slice, std::size_t frames);

/// "int16", "uint8", ...
std::string type_of(const DicomPixelFormat& format);

}  // namespace palpate::imaging
