// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <string>
#include <string_view>

namespace palpate::archive {

/// One entry of a coding scheme (PS3.3 8.8).
struct Code {
    std::string value, scheme, meaning;
};

/// What a segment is, in codes (PS3.3 C.8.20.2).
struct SegmentCodes {
    Code category;
    Code type;
    std::optional<Code> side;  ///< modifier of the type: left or right
    bool known = false;        ///< the name stands in the table
};

/// Finds the SNOMED CT codes of a structure by its name, without regard to case, blanks as underscores, left
/// or right before or behind it. A name that segment_codes.tsv does not have is an anatomical structure of
/// type tissue.
SegmentCodes codes_of(std::string_view name);

}  // namespace palpate::archive
