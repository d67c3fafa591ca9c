// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "formats/records/field.hpp"

namespace palpate {

/// What a region within a body makes of the stiffness of the surface, where it makes most of it.
struct FeltRegion {
    std::int32_t region = 0;
    std::int32_t vertex = 0;
    double depth = 0;              // mm
    double stiffness = 0;          // N/mm
    double stiffness_without = 0;  // N/mm
    double variation = 0;
};

/// What each is, in the order in which an asset has them.
inline constexpr std::tuple felt_region_fields{
    Field("region", &FeltRegion::region, "", "label value of the region", Range{.least = 1, .most = 65535}),
    Field("vertex", &FeltRegion::vertex, "",
          "surface vertex where the region changes the stiffness most, by part of it", not_negative),
    Field("depth", &FeltRegion::depth, "mm", "from that vertex to the region's nearest node", not_negative),
    Field("stiffness", &FeltRegion::stiffness, "N/mm", "of the surface there", positive),
    Field("stiffness_without", &FeltRegion::stiffness_without, "N/mm",
          "the same if the region were of the material around it", positive),
    Field(
        "variation", &FeltRegion::variation, "",
        "of the stiffness without the region around that vertex: half of what lies between 16 % and 84 % of "
        "the values, by their median",
        not_negative)};

/// Weber fraction of compliance, which people tell apart by pressing: 15 % (Tiest, Kappers 2009, Cues for
/// haptic perception of compliance, IEEE Transactions on Haptics 2:189-199).
inline constexpr double told_contrast = 0.15;
/// The least difference of force that counts as rendered where no device is named, N: the friction in the
/// joints of a Touch X by its data sheet, in which less is lost. A Premium 1.5 has 0.04 N, a Touch 0.26 N.
inline constexpr double rendered_force = 0.06;

/// How much stiffer the region makes the surface, as part of the stiffness without it; below 0 if softer.
inline double contrast_of(const FeltRegion& felt) {
    return (felt.stiffness - felt.stiffness_without) / felt.stiffness_without;
}

/// Why a hand can or cannot tell a region by pressing where it is told best.
enum class FeltVerdict {
    felt,        ///< none of the below
    too_faint,   ///< its contrast is below told_contrast
    too_varied,  ///< its contrast is below what the stiffness varies by around it anyway
    too_weak,    ///< it changes the force at the reference depth by less than a device renders
};

/// "felt", "too faint", "too varied", "too weak".
inline const char* verdict_word(FeltVerdict verdict) {
    constexpr std::array words{"felt", "too faint", "too varied", "too weak"};
    return words[static_cast<std::size_t>(verdict)];
}

/// The first that holds, in the order of the list from too_faint on. `depth` is that of the press, mm;
/// `rendered` the least difference of force that the device renders, N.
inline FeltVerdict verdict_of(const FeltRegion& felt, double depth, double rendered = rendered_force) {
    const double contrast = std::abs(contrast_of(felt));
    if (contrast < told_contrast) return FeltVerdict::too_faint;
    if (contrast < felt.variation) return FeltVerdict::too_varied;
    if (std::abs(felt.stiffness - felt.stiffness_without) * depth < rendered) return FeltVerdict::too_weak;
    return FeltVerdict::felt;
}

}  // namespace palpate
