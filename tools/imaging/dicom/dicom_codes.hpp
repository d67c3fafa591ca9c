// SPDX-License-Identifier: GPL-3.0-or-later
// For this folder only: codes of DICOM that messages may repeat, as no free text passes for one.
#pragma once
#include <string>

namespace palpate::imaging {

/// A Modality (PS3.3 C.7.3.1.1.1) as it is, empty if there is none, "other" for anything else.
std::string modality_code(const std::string& text);

/// A Photometric Interpretation (PS3.3 C.7.6.3.1.2) as it is, "other" for anything else.
std::string photometric_code(const std::string& text);

}  // namespace palpate::imaging
