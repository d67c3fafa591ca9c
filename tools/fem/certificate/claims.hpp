// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "formats/model/body.hpp"

namespace palpate::fem {

/// A figure of a certificate beside what its own sample gives when it is measured again.
struct Claim {
    std::string figure;   ///< a field of the certificate
    double claimed = 0;   ///< in the field's unit
    double found = 0;     ///< likewise
    std::string allowed;  ///< "at most 3.1e-08"
    bool holds = false;
};

/// Measures every figure of body.certificate again, by certify() with the certificate's own columns and
/// loads, and holds the claim against it. An error may not be larger than claimed, by a hundredth or by
/// float32's rounding of what the run time computes; eigenvalues, the discretisation error and what the
/// linear answer misses agree to a hundredth, counts exactly, and no tried load may have a smaller eigenvalue
/// than claimed. residual_double is left out: it is of a matrix in double that no file has. Throws as
/// certify(). Cost: certify(), and estimate_discretisation_error() and find_linear_limits() where they were
/// claimed.
std::vector<Claim> recheck_claims(const DeformableBody& body);

}  // namespace palpate::fem
