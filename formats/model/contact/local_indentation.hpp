// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace palpate {

/// What a sphere sinks into tissue beyond what the spread load lets the surface give way: see
/// load_shares.cpp.
struct LocalIndentation {
    double depth = 0;  ///< mm
    double slope = 0;  ///< of the depth by the force, mm/N
};
/// For a sphere of `radius` (mm) pressed with `force` (N).
LocalIndentation local_indentation(double force, double radius, double contact_modulus,
                                   double spread_radius) noexcept;

/// By how much more a force sinks in what presses `apart` (mm) from it than the spread load lets the surface
/// give way there, mm/N; below zero where that is too much.
double indentation_beside(double apart, double contact_modulus, double spread_radius) noexcept;

}  // namespace palpate
