// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <span>
#include <string>
#include <vector>

#include "formats/records/material.hpp"

namespace palpate::tissue {

/// A tissue's published values, a preset for case files.
struct Tissue {
    std::string name;     ///< "liver"
    std::string meaning;  ///< whose tissue, in which state
    double youngs_modulus_kpa = 0;
    double least_kpa = 0, most_kpa = 0;  ///< what is plausible: the sources' spread, generously
    double poissons_ratio = 0;
    double density_kg_m3 = 0;
    std::vector<RelaxationTerm> relaxation;  ///< none: no source was found that states a series
    std::string source;                      ///< of modulus, density and series, and how they follow
};

/// All presets, by name in alphabetical order.
std::span<const Tissue> tissues();

/// The preset of that name. Throws InvalidInput naming `culprit` and the nearest names if there is none.
const Tissue& require_tissue(const std::string& name, const std::string& culprit);

/// What soft tissue may have at all, kPa: from brain and fat to tendon-like scar. Beyond it a unit was
/// probably mistaken.
inline constexpr double least_soft_kpa = 0.1, most_soft_kpa = 1000;

}  // namespace palpate::tissue
