// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/report/verdict.hpp"

#include <algorithm>

#include "tools/report/html.hpp"

namespace palpate::report {

using html::significant;

namespace {

std::string percent(double part) {
    return significant(100 * part, 2) + " %";
}

}  // namespace

std::vector<Check> checks_of(const DeformableBody& body, const MeshSummary& mesh,
                             std::optional<AllowedLoadError> allowed_load_error) {
    const double limit = allowed_error(body.compliance);
    const std::string within = "≤ " + significant(limit, 1);
    const Certificate& c = body.certificate;
    const auto if_checked = [&](const std::string& figure) {
        return c.checked_strain < 0 ? "not checked" : figure;
    };
    const AllowedLoadError allowed = allowed_load_error.value_or(AllowedLoadError{limit, limit});
    return {
        {"Residual", significant(c.residual, 2), within,
         "Columns of the stored compliance against a fresh solution of the full sparse system: the largest "
         "difference, relative to the column's largest entry.",
         c.residual <= limit},
        {"Displacements under contacts", significant(c.load_error, 2), "≤ " + significant(allowed.surface, 1),
         "Random contacts of 1 to 32 nodes, " + html::grouped(c.sampled_loads) +
             " of them: the displaced surface against a fresh solution, the worst relative difference.",
         c.load_error <= allowed.surface},
        {"At the loaded nodes", significant(c.contact_error, 2), "≤ " + significant(allowed.contact, 1),
         "The same where the tool is, which is what a hand feels.", c.contact_error <= allowed.contact},
        {"Residual before rounding",
         c.residual_double < 0 ? "compressed at once" : significant(c.residual_double, 2), "",
         "The first in double precision, before the values were rounded or compressed for the runtime."},
        {"Columns solved again", html::grouped(c.sampled_columns), "≥ 1",
         "How many columns that comparison covers.", c.sampled_columns > 0},
        {"Asymmetry", significant(c.asymmetry, 2), "= 0",
         "Pressing at A and watching B must equal pressing at B and watching A, bit for bit.",
         c.asymmetry == 0},
        {"Reciprocity", significant(c.reciprocity, 2), within,
         "The same law for whole patterns of load, picked at random: the worst relative difference.",
         c.reciprocity <= limit},
        {"Smallest eigenvalue", significant(c.smallest_eigenvalue) + " mm/N", "> 0",
         "How little the surface gives way to the load it resists most. Positive means that every contact "
         "has "
         "exactly one answer and that the body cannot make energy of nothing.",
         c.smallest_eigenvalue > 0},
        {"Largest eigenvalue", significant(c.largest_eigenvalue) + " mm/N", "",
         "How far the surface gives way to the load it resists least."},
        {"Smallest eigenvalue on a contact", significant(c.smallest_patch_eigenvalue) + " mm/N", "> 0",
         "The same of the stored matrix over the nodes of those contacts.", c.smallest_patch_eigenvalue > 0},
        {"Condition number", significant(c.condition_number), "",
         "The ratio of these two; float32 holds seven digits."},
        {"Missed by the elements",
         c.discretisation_error < 0 ? "not estimated" : percent(c.discretisation_error), "",
         "Part of the work of a contact that richer elements would add (median); "
         "<code>palpate condense --discretisation-error</code> estimates it."},
        {"Strain up to which it was checked",
         if_checked(percent(c.checked_strain) + ", " + significant(c.checked_depth, 2) + " mm deep"), "",
         "Presses and lifts against neo-Hookean tissue of the same moduli: the largest strain of a "
         "tetrahedron, "
         "and how far they go, the median."},
        {"Force missed there", if_checked(percent(c.linear_force_error)), "",
         "By how much the linear answer is off at the same depth, the worst of them; "
         "<code>large_deformation = true</code> of a body solves what it misses."},
        {"Shape missed there", if_checked(percent(c.linear_surface_error)), "",
         "Largest difference of the displaced surface, of the largest displacement."},
        {"Smallest dihedral angle", significant(mesh.min_dihedral_deg) + "°", "> 0°",
         "The sharpest edge of any tetrahedron. Very flat tetrahedra make a body too stiff.",
         mesh.min_dihedral_deg > 0},
        {"Smallest tetrahedron", significant(mesh.min_volume) + " mm³", "> 0 mm³",
         "None is turned inside out.", mesh.min_volume > 0},
    };
}

}  // namespace palpate::report
