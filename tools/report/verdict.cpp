// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/report/verdict.hpp"

#include <algorithm>

#include "tools/report/html.hpp"

namespace palpate {

using html::significant;

std::vector<Check> checks_of(const DeformableBody& body, const MeshSummary& mesh) {
    // float32 rounds a column to 6e-8 of its largest entry; the rest up to the limit is the solver's.
    constexpr double residual_limit = 1e-6;
    constexpr double reciprocity_limit = 1e-6;
    const Certificate& c = body.certificate;
    return {
        {"Residual", significant(c.residual, 2), "≤ 1e-6",
         "Columns of the stored compliance against a fresh solution of the full sparse system: the largest "
         "difference, relative to the column's largest entry. At 1e-6 a push of 3 N is right to a millionth.",
         c.residual <= residual_limit},
        {"Residual before rounding", significant(c.residual_double, 2), "",
         "The same in double precision, before the values were rounded to 32 bits for the runtime."},
        {"Columns solved again", html::grouped(c.sampled_columns), "≥ 1",
         "How many columns that comparison covers.", c.sampled_columns > 0},
        {"Asymmetry", significant(c.asymmetry, 2), "= 0",
         "Pressing at A and watching B must equal pressing at B and watching A, bit for bit.",
         c.asymmetry == 0},
        {"Reciprocity", significant(c.reciprocity, 2), "≤ 1e-6",
         "The same law for whole patterns of load, picked at random: the worst relative difference.",
         c.reciprocity <= reciprocity_limit},
        {"Smallest eigenvalue", significant(c.smallest_eigenvalue) + " mm/N", "> 0",
         "How little the surface gives way to the load it resists most. Positive means that every contact "
         "has "
         "exactly one answer and that the body cannot make energy of nothing.",
         c.smallest_eigenvalue > 0},
        {"Largest eigenvalue", significant(c.largest_eigenvalue) + " mm/N", "",
         "How far the surface gives way to the load it resists least."},
        {"Condition number", significant(c.condition_number), "",
         "The ratio of these two; float32 holds seven digits."},
        {"Smallest dihedral angle", significant(mesh.min_dihedral_deg) + "°", "> 0°",
         "The sharpest edge of any tetrahedron. Very flat tetrahedra make a body too stiff.",
         mesh.min_dihedral_deg > 0},
        {"Smallest tetrahedron", significant(mesh.min_volume) + " mm³", "> 0 mm³",
         "None is turned inside out.", mesh.min_volume > 0},
    };
}

bool all_hold(const std::vector<Check>& checks) {
    return std::ranges::all_of(checks, &Check::holds);
}

}  // namespace palpate
