// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <array>

namespace palpate {

// Records that cross threads or go to files hold plain arrays; arithmetic wants vectors. Realtime-safe.

inline Eigen::Vector3d vector_of(const std::array<double, 3>& v) noexcept {
    return {v[0], v[1], v[2]};
}

inline std::array<double, 3> array_of(const Eigen::Vector3d& v) noexcept {
    return {v[0], v[1], v[2]};
}

/// A quaternion (x, y, z, w); zero is none.
inline Eigen::Quaterniond quaternion_of(const std::array<double, 4>& q) noexcept {
    return {q[3], q[0], q[1], q[2]};
}

inline std::array<double, 4> array_of(const Eigen::Quaterniond& q) noexcept {
    return {q.x(), q.y(), q.z(), q.w()};
}

}  // namespace palpate
