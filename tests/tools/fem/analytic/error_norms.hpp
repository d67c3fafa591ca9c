// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tests/tools/fem/analytic/elastic_system.hpp"
#include "tests/tools/fem/analytic/exact_fields.hpp"

namespace palpate::test {

/// How far computed displacements are from an exact field, each relative to the field's own norm.
struct RelativeErrors {
    double displacement;  ///< (integral of |u_h - u|²)^(1/2)
    double energy;        ///< (strain energy of u_h - u)^(1/2)
};

/// Integrates over every element by a rule of degree 5, with shape functions written here once more. The body
/// has one material.
RelativeErrors errors_against(const ElasticSystem& system, const Eigen::VectorXd& displacements,
                              const ExactField& field);

/// The order p of errors that fall as h^p from one mesh to one `refinement` times finer.
double order_of(double coarse_error, double fine_error, double refinement);

}  // namespace palpate::test
