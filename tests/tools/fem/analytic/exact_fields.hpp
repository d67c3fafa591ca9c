// SPDX-License-Identifier: GPL-3.0-or-later
// Exact displacement fields of linear elasticity, mm.
#pragma once
#include <Eigen/Core>
#include <cmath>
#include <functional>
#include <numbers>

#include "formats/model/body.hpp"

namespace palpate::test {

/// A displacement field with its gradient, d u_i / d x_j.
struct ExactField {
    std::function<Eigen::Vector3d(const Eigen::Vector3d&)> displacement;
    std::function<Eigen::Matrix3d(const Eigen::Vector3d&)> gradient;
};

/// Lamé's hollow sphere around the origin, inner radius a, outer radius b, under the inner pressure p
/// (N/mm²): u_r = p a³ / (E (b³ - a³)) [(1 - 2 nu) r + (1 + nu) b³ / (2 r²)]. Source: Timoshenko & Goodier,
/// Theory of Elasticity, hollow sphere; Code_Aster V3.03.123 gives it for the outer pressure.
inline ExactField lame_sphere(const Material& m, double a, double b, double pressure) {
    const double scale = pressure * a * a * a / (m.youngs_modulus * (b * b * b - a * a * a));
    const double A = scale * (1 - 2 * m.poissons_ratio), B = scale * (1 + m.poissons_ratio) * b * b * b / 2;
    // u = (A + B / r³) x
    return {[=](const Eigen::Vector3d& x) { return Eigen::Vector3d((A + B / std::pow(x.norm(), 3)) * x); },
            [=](const Eigen::Vector3d& x) {
                const double r = x.norm();
                return Eigen::Matrix3d((A + B / (r * r * r)) * Eigen::Matrix3d::Identity() -
                                       3 * B / std::pow(r, 5) * x * x.transpose());
            }};
}

/// Lamé's thick tube around the z axis in plane strain, inner radius a, outer radius b, inner pressure p
/// (N/mm²): u_r(r) = (1 + nu) p a² / (E (b² - a²)) [b² / r + (1 - 2 nu) r]. Source: MacNeal & Harder, Finite
/// Elem. Anal. Des. 1 (1985) 3-20, thick-walled cylinder; Code_Aster V3.04.130.
inline double lame_tube_radial(const Material& m, double a, double b, double pressure, double r) {
    return (1 + m.poissons_ratio) * pressure * a * a / (m.youngs_modulus * (b * b - a * a)) *
           (b * b / r + (1 - 2 * m.poissons_ratio) * r);
}

/// Boussinesq's half-space z <= 0 under a unit force (N) on the origin along -z. With depth c = -z, R = |x|:
/// u_radial = (1 + nu) / (2 pi E) [c r / R³ - (1 - 2 nu) r / (R (R + c))] outwards and
/// (1 + nu) / (2 pi E) [2 (1 - nu) / R + c² / R³] downwards. Source: Johnson, Contact Mechanics (1985),
/// eqs. 3.18.
inline Eigen::Vector3d boussinesq(const Material& m, const Eigen::Vector3d& x) {
    const double nu = m.poissons_ratio, c = -x.z(), R = x.norm();
    const double scale = (1 + nu) / (2 * std::numbers::pi * m.youngs_modulus);
    const double radial_over_r = scale * (c / (R * R * R) - (1 - 2 * nu) / (R * (R + c)));
    const double down = scale * (2 * (1 - nu) / R + c * c / (R * R * R));
    return {radial_over_r * x.x(), radial_over_r * x.y(), -down};
}

/// A bar hung at z = length, of weight `per_volume` (N/mm³) along -z, free to contract, its axis the z axis:
/// u_z = w / (2 E) [z² - length² + nu (x² + y²)], u_x = -nu w x z / E, u_y = -nu w y z / E. Source:
/// Timoshenko & Goodier, Theory of Elasticity, stretching of a prismatical bar by its own weight.
inline Eigen::Vector3d hung_bar(const Material& m, double per_volume, double length,
                                const Eigen::Vector3d& x) {
    const double nu = m.poissons_ratio, w = per_volume / m.youngs_modulus;
    return {-nu * w * x.x() * x.z(), -nu * w * x.y() * x.z(),
            w / 2 * (x.z() * x.z() - length * length + nu * (x.x() * x.x() + x.y() * x.y()))};
}

}  // namespace palpate::test
