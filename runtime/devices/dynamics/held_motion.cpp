// SPDX-License-Identifier: Apache-2.0
#include "runtime/devices/dynamics/held_motion.hpp"

#include <unsupported/Eigen/MatrixFunctions>

namespace palpate::devices {

HeldMotion::HeldMotion(double mass, double damping, double stiffness, double step_s) {
    Eigen::Matrix3d rates;
    rates << 0, 1, 0,                                  //
        -stiffness / mass, -damping / mass, 1 / mass,  //
        0, 0, 0;
    const Eigen::Matrix3d exact = (rates * step_s).exp();
    after_ = exact.topRows<2>();
}

}  // namespace palpate::devices
