// SPDX-License-Identifier: Apache-2.0
#include "formats/model/contact/local_indentation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

// By Hertz (1881) a force F sinks a sphere of radius r into a half-space by
//     delta(F) = (9 F² / (16 E*² r))^(1/3),    E* = E / (1 - nu²).
// Of that, a force spread with the density of load_shares.cpp lets the surface give way by c_R F, where
//     c_R = 1 / (pi E* R) int K(t)² dt = 0.76654 / (E* R),
// K(t) = 48 J3(t) / t³ being the density's Hankel transform. While c_R F is small, the sphere touches the
// surface so displaced in one place, and what it sinks in besides is
//     s(F) = delta(F) - c_R F.
// Pressed harder it comes to lie on more of the surface, as on any surface. Computed by rings on the kernel
// int K(t)² J0 J0 dt, s then stays between 0.107 and 0.142 R² / r up to 11 E* R³ / r. It is at its largest at
// F = 0.370 E* R³ / r, and beyond that it is left there: 2 % of the depth at most.
//
// Spheres that stand for one surface sink each other in. A force gives way by 1 / (pi E* d) at a distance d
// (Boussinesq 1885), of which spread loads give
//     m(d) = 1 / (pi E* R) int K(t)² J0(t d / R) dt,
// so that a force f_l adds (1 / (pi E* d) - m(d)) f_l to what another sphere sinks in: many small spheres are
// then as stiff as the surface, and not as many times as stiff as one of them.

namespace palpate {
namespace {

constexpr double spread_compliance = 0.76654;  // c_R E* R
constexpr double largest_alone = 0.3701;       // E* R³ / r

// m(d) E* R at d = 0, R / 4, R / 2 ...: a test computes them again.
constexpr std::array beside{0.76654, 0.72693, 0.62443, 0.49605, 0.37745, 0.28810, 0.22908, 0.19116, 0.16495,
                            0.14539, 0.13011, 0.11781, 0.10767, 0.09916, 0.09191, 0.08567, 0.08022};
constexpr double steps_of_radius = 4;

}  // namespace

LocalIndentation local_indentation(double force, double radius, double contact_modulus,
                                   double spread_radius) noexcept {
    if (!(contact_modulus > 0) || !(radius > 0) || !(spread_radius > 0)) return {};
    const double largest =
        largest_alone * contact_modulus * spread_radius * spread_radius * spread_radius / radius;
    const double f = std::min(std::max(force, 0.0), largest);
    if (!(f > 0)) return {};
    const double hertz = std::cbrt(9 * f * f / (16 * contact_modulus * contact_modulus * radius));
    const double spread = spread_compliance / (contact_modulus * spread_radius);
    return {hertz - spread * f, force < largest ? 2 * hertz / (3 * f) - spread : 0};
}

double indentation_beside(double apart, double contact_modulus, double spread_radius) noexcept {
    if (!(contact_modulus > 0) || !(apart > 0) || !(spread_radius > 0)) return 0;
    const double at = steps_of_radius * apart / spread_radius;
    const auto step = static_cast<std::size_t>(std::min(at, static_cast<double>(beside.size())));
    if (step + 1 >= beside.size()) return 0;  // a sixtieth of a point's at most
    const double between = at - static_cast<double>(step);
    const double given = (1 - between) * beside[step] + between * beside[step + 1];
    return (std::numbers::inv_pi * spread_radius / apart - given) / (contact_modulus * spread_radius);
}

}  // namespace palpate
