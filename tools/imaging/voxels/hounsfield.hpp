// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <string>

#include "tools/imaging/voxels/mask.hpp"

namespace palpate::imaging {

/// Adults' bone is at least this dense, HU: the lower end of InVesalius' preset for it.
inline constexpr double bone_from_hu = 226;

/// Voxels of lower ... upper HU, both included.
Mask threshold(const Volume& volume, double lower_hu, double upper_hu);

/// Voxels of `threshold_hu` or more in the body. The body is the largest piece of tissue (-300 HU and more)
/// after an opening by `separation_mm`, which cuts it from table and head rest, and what lies within
/// `separation_mm` of it.
Mask bone_of_body(const Volume& volume, double threshold_hu, double separation_mm);

/// Whether a value is -500 or less, as air has in HU and little else.
bool holds_air(const Volume& volume);

/// Whether the values are a CT's: HU, or as far above them as hounsfield_offset() can tell.
bool is_ct(const Volume& volume);

/// How far the values of a CT probably lie above HU: 0 if one is negative, or unless soft tissue lies about
/// the offset and little between it and air; else 1000 if the commonest value of the air (-1000 HU) lies
/// below 14, and otherwise 1024, the usual one. The air decides no finer: old scanners have it
/// tens of HU off.
double hounsfield_offset(const Volume& volume);

/// HU = scale * value + offset.
struct HounsfieldScale {
    double scale = 1, offset = 0;

    bool operator==(const HounsfieldScale&) const = default;
};

/// Takes the values to HU.
void rescale(Volume& volume, const HounsfieldScale& to_hounsfield);

/// The scale of a CT in other units, as in 8 bit, by its air (-1000 HU) and soft tissue (40 HU): the values
/// about which most lie, of the lowest quarter and of those above. To some 4 % where air is stored as such.
/// Nothing where a value is negative, most of what is no air is no soft tissue or fat by that scale, or the
/// brightest value is not bone's or metal's: so for most MRI, for windows that cut air off, and where fat is
/// the commonest.
std::optional<HounsfieldScale> scale_by_air_and_soft_tissue(const Volume& volume);

/// "HU = 16.05 x value - 1025".
std::string text_of(const HounsfieldScale& to_hounsfield);

}  // namespace palpate::imaging
