// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>

#include "formats/model/body.hpp"
#include "tools/fem/condense.hpp"

namespace palpate {

/// Columns that a certificate re-solves, and the seed that picks them.
inline constexpr std::int32_t certificate_columns = 16;
inline constexpr std::uint64_t certificate_seed = 20261;

/// Certifies a freshly condensed compliance, in double and as stored: random columns are re-solved with a
/// second factorisation in another elimination order (so an error of the condensation cannot hide),
/// reciprocity is tested with random loads, eigenvalue estimates are taken from `exact`.
Certificate certify(const DeformableBody& body, const ExactCompliance& exact);

/// Rechecks a stored compliance from mesh, materials and fixed nodes alone: residual of `columns` re-solved
/// columns, asymmetry, reciprocity, eigenvalue estimates. smallest_eigenvalue is 0 if the stored matrix is
/// not positive definite (LAPACK dpotrf in double). Throws InvalidInput if the stiffness is singular. Cost:
/// one sparse factorisation and 1/3 (3m)³ flops.
Certificate recertify(const DeformableBody& body, std::int32_t columns, std::uint64_t seed);

}  // namespace palpate
