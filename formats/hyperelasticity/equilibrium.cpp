// SPDX-License-Identifier: Apache-2.0
#include "formats/hyperelasticity/equilibrium.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "formats/model/errors.hpp"

namespace palpate::hyperelasticity {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double sufficient = 1e-4;        // of the decrease that the slope promises
constexpr int most_trials = 30;            // along a direction
constexpr double energy_rounding = 1e-12;  // relative

// Of a regular tetrahedron of the mesh's mean volume.
double mean_edge(const TetMesh& mesh) {
    double six_volumes = 0;
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) six_volumes += six_volume(mesh, t);
    return std::cbrt(std::numbers::sqrt2 * six_volumes / static_cast<double>(mesh.tetrahedra.size()));
}

// The body. Left to turn, it may have a factor all the same, by rounding.
const DeformableBody& held(const DeformableBody& body) {
    if (body.fixed_nodes.size() < 3)
        throw InvalidInput({body.name, "holds " + std::to_string(body.fixed_nodes.size()) + " nodes",
                            "at least 3, not in a line", "fix more of its nodes"});
    return body;
}

}  // namespace

Equilibrium::Equilibrium(const DeformableBody& body)
    : mesh_(body),
      edge_(mean_edge(body.mesh)),
      factor_(held(body), mesh_),
      displacements_(VectorXd::Zero(mesh_.dofs())),
      internal_(VectorXd::Zero(mesh_.dofs())),
      residual_(mesh_.dofs()),
      direction_(mesh_.dofs()),
      tried_(mesh_.dofs()),
      tried_internal_(mesh_.dofs()),
      steps_(mesh_.dofs(), remembered),
      changes_(mesh_.dofs(), remembered) {}

void Equilibrium::reset() noexcept {
    displacements_.setZero();
    internal_.setZero();
    energy_ = 0;
    known_ = 0;
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
    factor_.solve(tried_, direction_);
    for (Index k = known_; k-- > 0;) {
        const Index i = (newest_ + remembered - k) % remembered;
        const double back = inverse_[i] * changes_.col(i).dot(direction_);
        direction_ += (along[static_cast<std::size_t>(i)] - back) * steps_.col(i);
    }
}

// Takes the longest part of the direction, halved as need be, that lowers the energy; false if none does.
// What turns elements inside out is an edge long at most when it is tried again. Where rounding hides what
// energy is won, the slope at the end tells of it (Hager, Zhang, SIAM J. Optim. 16:170-192, 2005, eq. 4.1).
bool Equilibrium::descend(const VectorXd& loads, double slope) noexcept {
    const double work = loads.dot(displacements_), before = energy_ - work;
    const double rounding = energy_rounding * (std::abs(energy_) + std::abs(work));
    double part = 1;
    for (int trial = 0; trial < most_trials; ++trial, part /= 2) {
        tried_ = displacements_ + part * direction_;
        const double energy = mesh_.forces(tried_, tried_internal_), after = energy - loads.dot(tried_);
        if (energy == std::numeric_limits<double>::infinity()) {
            part = std::min(part, 2 * edge_ / direction_.lpNorm<Eigen::Infinity>());
            continue;
        }
        const bool lower = after <= before - sufficient * part * slope;
        if (!lower && !(after <= before + rounding &&
                        direction_.dot(tried_internal_ - loads) <= (1 - 2 * sufficient) * slope))
            continue;
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
        energy_ = energy;
        return true;
    }
    return false;
}

double Equilibrium::approach(const VectorXd& loads, double settled, int most) noexcept {
    double missing = std::numeric_limits<double>::infinity();
    for (int step = 0; step < most && !(missing < settled); ++step) {
        residual_ = loads - internal_;
        set_direction();
        double slope = direction_.dot(residual_);
        bool lower = slope > 0 && descend(loads, slope);
        if (!lower && known_ > 0) {  // the steps that are known mislead
            known_ = 0;
            set_direction();
            slope = direction_.dot(residual_);
            lower = slope > 0 && descend(loads, slope);
        }
        if (std::isfinite(slope)) missing = direction_.lpNorm<Eigen::Infinity>();
        if (!lower) break;
    }
    return missing;
}

}  // namespace palpate::hyperelasticity
