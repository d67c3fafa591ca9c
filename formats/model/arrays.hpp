// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <array>

namespace palpate {

// Records that cross threads or go to files hold plain arrays; arithmetic wants vectors. Realtime-safe.

inline Eigen::Vector3d vector_of(const std::array<double, 3>& v) noexcept {
    return {v[0], v[1], v[2]};
}

inline std::array<double, 3> array_of(const Eigen::Vector3d& v) noexcept {
    return {v[0], v[1], v[2]};
}

}  // namespace palpate
