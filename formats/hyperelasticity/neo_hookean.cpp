// SPDX-License-Identifier: Apache-2.0
#include "formats/hyperelasticity/neo_hookean.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

namespace palpate::hyperelasticity {

Moduli moduli_of(const Material& material) {
    const double e = material.youngs_modulus, nu = material.poissons_ratio;
    return {e / (2 * (1 + nu)), e / (3 * (1 - 2 * nu))};
}

Stressed neo_hookean(const Eigen::Matrix3d& F, const Moduli& moduli) noexcept {
    Eigen::Matrix3d cofactors;  // J F^(-T)
    cofactors.col(0) = F.col(1).cross(F.col(2));
    cofactors.col(1) = F.col(2).cross(F.col(0));
    cofactors.col(2) = F.col(0).cross(F.col(1));
    const double J = F.col(0).dot(cofactors.col(0));
    if (!(J > 0)) return {std::numeric_limits<double>::infinity(), Eigen::Matrix3d::Zero()};
    const double cube_root = std::cbrt(J);
    const double scaled = moduli.shear / (cube_root * cube_root), trace = F.squaredNorm();
    Stressed stressed;
    stressed.energy = (scaled * trace - 3 * moduli.shear + moduli.bulk * (J - 1) * (J - 1)) / 2;
    stressed.stress = scaled * F + (moduli.bulk * (J - 1) - scaled * trace / (3 * J)) * cofactors;
    return stressed;
}

}  // namespace palpate::hyperelasticity
