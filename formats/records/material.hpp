// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "formats/records/field.hpp"

namespace palpate {

/// Isotropic linear elasticity.
struct Material {
    double youngs_modulus = 0;  ///< N/mm² (MPa); 1 kPa is 1e-3 N/mm²
    double poissons_ratio = 0;
};

inline constexpr std::tuple material_fields{
    Field("youngs_modulus", &Material::youngs_modulus, "N/mm²", "Young's modulus", positive)
        .written_in("kPa", 1e3),
    Field("poissons_ratio", &Material::poissons_ratio, "",
          "Poisson's ratio; linear tetrahedra lock as it approaches 0.5",
          Range{.least = -1, .most = 0.5, .ends_belong = false})};

}  // namespace palpate
