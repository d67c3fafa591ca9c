// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <string_view>

namespace palpate::archive {

/// What stands where an object must have a value and the truth would tell a patient, a day or a machine.
inline constexpr std::string_view anonymous_name = "ANONYMOUS^PATIENT";
inline constexpr std::string_view anonymous_id_prefix =
    "ANON-";  ///< then 12 hex digits of the content's digest
inline constexpr std::string_view no_date = "19000101";
inline constexpr std::string_view no_time = "000000";
inline constexpr std::string_view no_serial_number = "none";
/// Series descriptions of ours.
inline constexpr std::string_view segmentation_series = "Palpate segmentation";
inline constexpr std::string_view surface_series = "Palpate surface";

}  // namespace palpate::archive
