// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <string_view>

namespace palpate {

/// How contact with the surface is found and kept.
enum class ContactScheme {
    single,      ///< published: inside or outside at 30 Hz decides
    twice,       ///< published: the same, and a second test of the last position between two detections
    continuous,  ///< ours: every tick sweeps the tool from the last to the present position
};

/// In the order of ContactScheme.
inline constexpr std::array<std::string_view, 3> contact_scheme_names{"single", "twice", "continuous"};

/// By name; throws UsageError listing the names.
ContactScheme find_contact_scheme(std::string_view name);

}  // namespace palpate
