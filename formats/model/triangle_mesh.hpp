// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "formats/records/eigen_layout.hpp"

namespace palpate {

using Triangle = std::array<std::int32_t, 3>;

/// A triangle surface in frame P (LPS, mm). Seen from outside, vertices run counter-clockwise, so
/// (p1 - p0) x (p2 - p0) points outwards.
struct TriangleMesh {
    std::vector<Eigen::Vector3d> vertices;  ///< p_P, mm
    std::vector<Triangle> triangles;        ///< vertex indices
};

}  // namespace palpate
