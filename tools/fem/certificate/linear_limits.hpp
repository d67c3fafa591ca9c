// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <cstdint>

#include "formats/model/body.hpp"

namespace palpate::fem {

/// Places of the contact surface that are pressed and lifted, and the seed that picks them.
inline constexpr std::int32_t linear_limit_places = 4;
inline constexpr std::uint64_t linear_limit_seed = 4711;

/// The strain to which they are pressed and lifted, of the tetrahedron that is strained most.
inline constexpr double linear_limit_strain = 0.25;

/// Free degrees of freedom of bodies that are looked at, at most: the factor of a liver of 32 604 took 22 s,
/// with which a condensation of 30 s took 70.
inline constexpr std::size_t linear_limit_dofs = 20000;

/// Up to which strain the linear answer was held against neo-Hookean tissue, and how far it is off there.
struct LinearLimits {
    double strain = -1;         ///< largest principal one, abs(stretch - 1), of a tetrahedron by its corners
    double depth = -1;          ///< mean way of what is pressed, along the force, mm
    double force_error = -1;    ///< abs(F_linear / F - 1) at the same depth
    double surface_error = -1;  ///< largest abs(u_linear - u) of a contact node so, of the largest abs(u)
};

/// Presses and lifts the body at linear_limit_places by forces along the normal on the contact nodes within a
/// radius of a tenth of the body's size (cube root of its volume; at least the mean distance of its contact
/// nodes), shared as 1 - (distance / radius)², farther than that from held nodes where there are such, until
/// a tetrahedron is strained by `strain`: the least strain that was reached, the median depth, and the worst
/// errors. Neo-Hookean tissue of the same moduli on the body's own elements (hyperelasticity::Equilibrium) is
/// the judge of the stored compliance. All -1 where that has no answer: for more than linear_limit_dofs,
/// Poisson's ratios above 0.4999, bodies that Equilibrium refuses, and where no rest was found. Cost: a
/// factorisation in single precision and some hundred solves; 3 s for 3500 nodes.
LinearLimits find_linear_limits(const DeformableBody& body, double strain = linear_limit_strain);

/// Writes them into the certificate's fields.
void set_linear_limits(Certificate& certificate, const LinearLimits& limits);

}  // namespace palpate::fem
