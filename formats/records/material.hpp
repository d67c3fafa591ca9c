// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <tuple>

#include "formats/records/field.hpp"

namespace palpate {

/// Isotropic linear elasticity.
struct Material {
    double youngs_modulus = 0;  ///< N/mm² (MPa); 1 kPa is 1e-3 N/mm²
    double poissons_ratio = 0;
};

/// N/mm²: from 1 Pa, some thousandth of the softest tissue, to beyond diamond. Far outside, sums of
/// compliances over a body leave what a double holds, or are those of a single soft element.
inline constexpr Range possible_modulus{.least = 1e-6, .most = 2e6};

inline constexpr std::tuple material_fields{
    Field("youngs_modulus", &Material::youngs_modulus, "N/mm²", "Young's modulus", possible_modulus)
        .written_in("kPa", 1e3),
    Field("poissons_ratio", &Material::poissons_ratio, "",
          "Poisson's ratio; linear tetrahedra lock as it approaches 0.5",
          Range{.least = -1, .most = 0.5, .ends_belong = false})};

/// A term of the series by which a material under a lasting strain relaxes:
///     E(t) = E (1 - sum share_k (1 - exp(-t / time_k))),
/// E being Young's modulus, which is what a quick press feels. Poisson's ratio stays as it is.
struct RelaxationTerm {
    double share = 0;
    double time = 0;  ///< s
};

inline constexpr std::tuple relaxation_fields{
    Field("share", &RelaxationTerm::share, "", "part of Young's modulus that is lost in time",
          Range{.least = 0, .most = 1, .ends_belong = false}),
    Field("time", &RelaxationTerm::time, "s", "after which 1/e of that part is left",
          Range{.least = 1e-3, .most = 1e6})};

/// Part of Young's modulus that all terms of a material may take together.
inline constexpr double most_relaxation = 0.9999;

/// Most terms of one material.
inline constexpr std::size_t most_relaxation_terms = 4;

/// Returns what makes no sense of a material's series; none if it is sound: at most most_relaxation_terms,
/// in ascending order of their times, all different, and most_relaxation at most together.
std::optional<FieldError> relaxation_error(std::span<const RelaxationTerm> terms);

/// "30 % in 1 s, 20 % in 10 s"; "none" without terms.
std::string relaxation_text(std::span<const RelaxationTerm> terms);

}  // namespace palpate
