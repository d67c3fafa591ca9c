// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>

#include "formats/records/material.hpp"

namespace palpate::hyperelasticity {

/// Shear and bulk modulus at rest, N/mm².
struct Moduli {
    double shear = 0, bulk = 0;
};
/// mu = E / (2 (1 + nu)), kappa = E / (3 (1 - 2 nu)). Unchecked: E > 0, -1 < nu < 0.5.
Moduli moduli_of(const Material& material);

/// Energy density (N/mm²) and first Piola-Kirchhoff stress P = dW/dF (N/mm²) of a state.
struct Stressed {
    double energy = 0;
    Eigen::Matrix3d stress = Eigen::Matrix3d::Zero();
};

/// A compressible neo-Hookean material under the deformation gradient F, J = det F:
///     W = mu/2 (J^(-2/3) tr(FᵀF) - 3) + kappa/2 (J - 1)²,
///     P = mu J^(-2/3) (F - tr(FᵀF)/3 F^(-T)) + kappa (J - 1) J F^(-T).
/// Its tangent at F = I is Hooke's law of the same moduli. Infinite energy where J <= 0. Realtime-safe.
/// Sources: Bonet, Wood, Nonlinear Continuum Mechanics for Finite Element Analysis (2008), 6.4, 6.5; the
/// volumetric term is that of Abaqus and of CalculiX' *HYPERELASTIC, NEO HOOKE with C10 = mu/2, D1 = 2/kappa.
Stressed neo_hookean(const Eigen::Matrix3d& F, const Moduli& moduli) noexcept;

}  // namespace palpate::hyperelasticity
