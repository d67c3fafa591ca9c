// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
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

}  // namespace palpate::imaging
