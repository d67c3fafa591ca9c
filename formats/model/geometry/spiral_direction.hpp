// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cmath>
#include <numbers>

namespace palpate {

/// The i-th of `count` evenly spread unit directions with a positive third coordinate, from that axis
/// outwards: a spiral by the golden angle.
inline Eigen::Vector3d spiral_direction(int i, int count) {
    const double height = 1 - (i + 0.5) / count;
    const double across = std::sqrt(1 - height * height);
    const double turn = i * std::numbers::pi * (3 - std::sqrt(5.0));
    return {across * std::cos(turn), across * std::sin(turn), height};
}

}  // namespace palpate
