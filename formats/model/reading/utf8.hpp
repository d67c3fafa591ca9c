// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string_view>

namespace palpate {

/// Whether a text is well-formed UTF-8 (Unicode 15, table 3-7): no overlong forms, no surrogates, U+10FFFF at
/// most.
bool is_utf8(std::string_view text);

/// Whether it is so, and without control characters (C0, C1, U+007F) and those that are not seen or turn the
/// direction of writing, by which a name would look like another.
bool is_printable(std::string_view text);

}  // namespace palpate
