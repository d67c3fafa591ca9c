// SPDX-License-Identifier: Apache-2.0
#include "formats/hyperelasticity/equilibrium.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "formats/elasticity/stiffness.hpp"

namespace palpate::hyperelasticity {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double sufficient = 1e-4;        // of the decrease that the slope promises
constexpr double shortest_step = 1e-3;     // of the quasi-Newton step
constexpr double energy_rounding = 1e-12;  // relative

}  // namespace

Equilibrium::Equilibrium(const DeformableBody& body)
    : mesh_(body),
      permuted_(mesh_.dofs()),
      displacements_(VectorXd::Zero(mesh_.dofs())),
      internal_(VectorXd::Zero(mesh_.dofs())),
      residual_(mesh_.dofs()),
      direction_(mesh_.dofs()),
      tried_(mesh_.dofs()),
      tried_internal_(mesh_.dofs()),
      steps_(mesh_.dofs(), remembered),
      changes_(mesh_.dofs(), remembered) {
    factor_.compute(
        elasticity::assemble_stiffness(body.mesh, body.materials, mesh_.discretisation(), mesh_.positions())
            .cast<float>());
}

void Equilibrium::reset() noexcept {
    displacements_.setZero();
    internal_.setZero();
    energy_ = 0;
    known_ = 0;
}

// What a force displaces tissue at rest by.
void Equilibrium::soften(const VectorXd& force, VectorXd& moved) noexcept {
    permuted_.noalias() = factor_.permutationP() * force.cast<float>();
    factor_.matrixL().solveInPlace(permuted_);
    factor_.matrixU().solveInPlace(permuted_);
    const auto& place = factor_.permutationP().indices();
    for (Index i = 0; i < moved.size(); ++i) moved[i] = static_cast<double>(permuted_[place[i]]);
}

// H residual, H the inverse tangent as rest and the last steps have it.
void Equilibrium::set_direction() noexcept {
    std::array<double, remembered> along;
    tried_ = residual_;
    for (Index k = 0; k < known_; ++k) {
        const Index i = (newest_ + remembered - k) % remembered;
        along[static_cast<std::size_t>(i)] = inverse_[i] * steps_.col(i).dot(tried_);
        tried_ -= along[static_cast<std::size_t>(i)] * changes_.col(i);
    }
    soften(tried_, direction_);
    for (Index k = known_; k-- > 0;) {
        const Index i = (newest_ + remembered - k) % remembered;
        const double back = inverse_[i] * changes_.col(i).dot(direction_);
        direction_ += (along[static_cast<std::size_t>(i)] - back) * steps_.col(i);
    }
}

double Equilibrium::approach(const VectorXd& loads, double settled, int most) noexcept {
    double moved = 0;
    for (int step = 0; step < most; ++step) {
        residual_ = loads - internal_;
        set_direction();
        double slope = direction_.dot(residual_);
        if (!(slope > 0)) {  // the steps that are known mislead
            known_ = 0;
            set_direction();
            slope = direction_.dot(residual_);
        }
        const double before = energy_ - loads.dot(displacements_);
        const double rounding = energy_rounding * (energy_ + std::abs(loads.dot(displacements_)));
        double part = 1, after = 0;
        for (;; part /= 2) {
            tried_ = displacements_ + part * direction_;
            after = mesh_.forces(tried_, tried_internal_);
            if (after - loads.dot(tried_) <= before - sufficient * part * slope + rounding) break;
            if (part < shortest_step) {
                known_ = 0;
                return direction_.lpNorm<Eigen::Infinity>();
            }
        }
        const double curvature = part * direction_.dot(tried_internal_ - internal_);
        if (curvature > 0) {
            newest_ = (newest_ + 1) % remembered;
            steps_.col(newest_) = part * direction_;
            changes_.col(newest_) = tried_internal_ - internal_;
            inverse_[newest_] = 1 / curvature;
            known_ = std::min(known_ + 1, remembered);
        }
        displacements_.swap(tried_);
        internal_.swap(tried_internal_);
        energy_ = after;
        moved = part * direction_.lpNorm<Eigen::Infinity>();
        if (moved < settled) break;
    }
    return moved;
}

}  // namespace palpate::hyperelasticity
