// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>

namespace palpate::devices {

/// How an offset x and its velocity go on over a step of time in which F is constant: the exact solution of
/// m x'' + c x' + k x = F. In translation in mm, N and m in N s²/mm; in rotation in rad, N mm and N mm s².
class HeldMotion {
  public:
    /// `mass`: m, above zero (unchecked), `damping`: c, `stiffness`: k; `step_s`: of each step, s.
    HeldMotion(double mass, double damping, double stiffness, double step_s);

    Eigen::Vector3d offset(const Eigen::Vector3d& x, const Eigen::Vector3d& velocity,
                           const Eigen::Vector3d& force) const noexcept {
        return after_(0, 0) * x + after_(0, 1) * velocity + after_(0, 2) * force;
    }
    Eigen::Vector3d velocity(const Eigen::Vector3d& x, const Eigen::Vector3d& velocity,
                             const Eigen::Vector3d& force) const noexcept {
        return after_(1, 0) * x + after_(1, 1) * velocity + after_(1, 2) * force;
    }

  private:
    Eigen::Matrix<double, 2, 3> after_;  // (x, x') after a step from (x, x', F)
};

}  // namespace palpate::devices
