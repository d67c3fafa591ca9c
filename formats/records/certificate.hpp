// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "formats/records/field.hpp"

namespace palpate {

/// What was measured about a compliance C when it was made. "Stored" means as the file has it.
struct Certificate {
    double residual = 0;
    double residual_double = 0;
    double asymmetry = 0;
    double smallest_eigenvalue = 0;  // mm/N
    double largest_eigenvalue = 0;   // mm/N
    double condition_number = 0;
    double reciprocity = 0;
    std::int32_t sampled_columns = 0;
    double load_error = 0;
    double contact_error = 0;
    std::int32_t sampled_loads = 0;
    double smallest_patch_eigenvalue = 0;  // mm/N
    double discretisation_error = -1;
    double checked_strain = -1;
    double checked_depth = -1;  // mm
    double linear_force_error = -1;
    double linear_surface_error = -1;
    std::int64_t free_dofs = 0;
};

/// What each is, in the order in which an asset has them.
inline constexpr std::tuple certificate_fields{
    Field("residual", &Certificate::residual, "",
          "worst difference of a stored column to the same column solved again, relative to its largest "
          "entry",
          not_negative),
    Field("residual_double", &Certificate::residual_double, "",
          "the same before rounding; -1 where the compliance was compressed at once and never was in double",
          not_negative)
        .none_is(-1),
    Field("asymmetry", &Certificate::asymmetry, "",
          "largest difference between the stored C and its transpose, relative to its largest entry; 0 by "
          "construction",
          not_negative),
    Field("smallest_eigenvalue", &Certificate::smallest_eigenvalue, "mm/N", "of C, estimated"),
    Field("largest_eigenvalue", &Certificate::largest_eigenvalue, "mm/N", "of C, estimated"),
    Field("condition_number", &Certificate::condition_number, "", "largest / smallest eigenvalue"),
    Field("reciprocity", &Certificate::reciprocity, "",
          "worst violation of Maxwell and Betti's theorem by random loads a and b on the stored matrix: "
          "abs(aᵀCb - bᵀCa) / sqrt(aᵀCa bᵀCb)",
          not_negative),
    Field("load_error", &Certificate::load_error, "",
          "worst error of the stored matrix' displacements under random contact loads, relative, 2-norm over "
          "the whole contact surface",
          not_negative),
    Field("contact_error", &Certificate::contact_error, "",
          "the same at the loaded nodes alone, largest entries in place of norms", not_negative),
    Field("sampled_loads", &Certificate::sampled_loads, "", "random contact loads"),
    Field("smallest_patch_eigenvalue", &Certificate::smallest_patch_eigenvalue, "mm/N",
          "of the stored matrix over the nodes of such a load, the smallest found"),
    Field("discretisation_error", &Certificate::discretisation_error, "",
          "part of a contact load's work that the elements miss, against richer ones, median over loads; -1 "
          "where it was not estimated",
          not_negative)
        .none_is(-1),
    Field("checked_strain", &Certificate::checked_strain, "",
          "largest principal strain of a tetrahedron up to which presses and lifts were held against "
          "neo-Hookean tissue of the same moduli; -1 where none were",
          not_negative)
        .none_is(-1),
    Field("checked_depth", &Certificate::checked_depth, "mm", "how deep those go, the median; -1 as above",
          not_negative)
        .none_is(-1),
    Field(
        "linear_force_error", &Certificate::linear_force_error, "",
        "by how much the linear answer's force is off there at the same depth, relative, the worst of them; "
        "-1 as above",
        not_negative)
        .none_is(-1),
    Field("linear_surface_error", &Certificate::linear_surface_error, "",
          "largest difference of a contact node's displacement there at the same depth, of the largest "
          "displacement, the worst of them; -1 as above",
          not_negative)
        .none_is(-1),
    Field("sampled_columns", &Certificate::sampled_columns, "", "columns that were solved again"),
    Field("free_dofs", &Certificate::free_dofs, "",
          "size of K without fixed nodes, middles of edges included")};

}  // namespace palpate
