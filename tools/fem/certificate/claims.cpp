// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/fem/certificate/claims.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "tools/fem/certificate/certificate.hpp"
#include "tools/fem/certificate/discretisation_error.hpp"
#include "tools/fem/certificate/linear_limits.hpp"

namespace palpate::fem {
namespace {

constexpr double part = 0.01;  // other kernels, other orders of sums
// What products in float32 may differ by from one processor to another; never more than what is claimed, so
// that nothing passes for exact.
constexpr double float_rounding = 5e-7;

Claim at_most(const char* figure, double claimed, double found, double noise = 0) {
    const double limit = claimed + std::max({part * claimed, std::min(claimed, float_rounding), noise});
    return {figure, claimed, found, fmt::format("at most {:g}", claimed), found <= limit};
}

Claim at_least(const char* figure, double claimed, double found) {
    return {figure, claimed, found, fmt::format("at least {:g}", claimed),
            found >= claimed - part * std::abs(claimed)};
}

Claim about(const char* figure, double claimed, double found) {
    return {figure, claimed, found, fmt::format("{:g}", claimed),
            std::abs(found - claimed) <= part * std::abs(claimed)};
}

Claim equal(const char* figure, double claimed, double found) {
    return {figure, claimed, found, fmt::format("{:g}", claimed), found == claimed};
}

void add_linear_limits(const DeformableBody& body, std::vector<Claim>& claims) {
    const Certificate& claimed = body.certificate;
    const LinearLimits found = find_linear_limits(body);
    claims.push_back(about("checked_strain", claimed.checked_strain, found.strain));
    claims.push_back(about("checked_depth", claimed.checked_depth, found.depth));
    claims.push_back(about("linear_force_error", claimed.linear_force_error, found.force_error));
    claims.push_back(about("linear_surface_error", claimed.linear_surface_error, found.surface_error));
}

}  // namespace

std::vector<Claim> recheck_claims(const DeformableBody& body) {
    const Certificate& claimed = body.certificate;
    const Certificate found = certify(body, certificate_sample(body));
    std::vector<Claim> claims{
        equal("sampled_columns", claimed.sampled_columns, found.sampled_columns),
        equal("sampled_loads", claimed.sampled_loads, found.sampled_loads),
        equal("free_dofs", static_cast<double>(claimed.free_dofs), static_cast<double>(found.free_dofs)),
        at_most("residual", claimed.residual, found.residual),
        at_most("asymmetry", claimed.asymmetry, found.asymmetry),
        at_most("reciprocity", claimed.reciprocity, found.reciprocity,
                float_rounding),  // rounding, and no more
        at_most("load_error", claimed.load_error, found.load_error),
        at_most("contact_error", claimed.contact_error, found.contact_error),
        about("smallest_eigenvalue", claimed.smallest_eigenvalue, found.smallest_eigenvalue),
        about("largest_eigenvalue", claimed.largest_eigenvalue, found.largest_eigenvalue),
        about("condition_number", claimed.condition_number, found.condition_number),
        at_least("smallest_patch_eigenvalue", claimed.smallest_patch_eigenvalue,
                 found.smallest_patch_eigenvalue)};
    if (claimed.discretisation_error >= 0)
        claims.push_back(
            about("discretisation_error", claimed.discretisation_error, estimate_discretisation_error(body)));
    if (claimed.checked_strain >= 0) add_linear_limits(body, claims);
    return claims;
}

}  // namespace palpate::fem
