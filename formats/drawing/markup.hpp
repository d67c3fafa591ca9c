// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>

namespace palpate::drawing {

/// Replaces & < > " ' by character references, so that text may stand in XML or HTML, also as an attribute.
std::string escaped(std::string_view text);

}  // namespace palpate::drawing
