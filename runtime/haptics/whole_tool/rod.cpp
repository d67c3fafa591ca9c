// SPDX-License-Identifier: Apache-2.0
#include "runtime/haptics/whole_tool/rod.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

namespace palpate::haptics {

using Eigen::Vector3d;

TriangleMesh rod_surface(double radius, double length) {
    constexpr std::int32_t around = 24, quarter = 6;  // rings from a ball's pole to where it is widest
    struct Ring {
        double width, height;
    };
    std::vector<Ring> rings;
    for (std::int32_t k = 1 - quarter; k < quarter; ++k) {
        const double latitude = 0.5 * std::numbers::pi * k / quarter;
        rings.push_back({radius * std::cos(latitude), radius * std::sin(latitude) + (k > 0 ? length : 0)});
        if (k == 0 && length > 0) rings.push_back({radius, length});
    }
    TriangleMesh mesh;
    mesh.vertices.push_back({0, 0, -radius});
    for (const Ring& ring : rings)
        for (std::int32_t k = 0; k < around; ++k) {
            const double longitude = 2 * std::numbers::pi * k / around;
            mesh.vertices.push_back(
                {ring.width * std::cos(longitude), ring.width * std::sin(longitude), ring.height});
        }
    mesh.vertices.push_back({0, 0, radius + length});
    const auto last = static_cast<std::int32_t>(mesh.vertices.size()) - 1;
    for (std::int32_t k = 0; k < around; ++k) {
        const std::int32_t next = (k + 1) % around;
        mesh.triangles.push_back({0, 1 + next, 1 + k});
        for (std::int32_t below = 1; below + around < last; below += around) {
            const std::int32_t a = below + k, b = below + next;
            mesh.triangles.push_back({a, b, b + around});
            mesh.triangles.push_back({a, b + around, a + around});
        }
        mesh.triangles.push_back({last, last - around + k, last - around + next});
    }
    return mesh;
}

}  // namespace palpate::haptics
