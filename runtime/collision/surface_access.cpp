// SPDX-License-Identifier: Apache-2.0
// Apart from the constructor, which allocates and throws: the tick's objects do neither.
#include "runtime/collision/collision_surface.hpp"

namespace palpate::collision {

TriangleCorners CollisionSurface::corners(std::int32_t slot) const noexcept {
    const float* c = triangles_[slot].corners;
    return {Eigen::Vector3d(c[0], c[1], c[2]), Eigen::Vector3d(c[3], c[4], c[5]),
            Eigen::Vector3d(c[6], c[7], c[8])};
}

ObbNode CollisionSurface::node(std::int32_t index) const noexcept {
    const Node& from = nodes_[index];
    ObbNode to{Eigen::Map<const Eigen::Matrix3f>(from.axes), Eigen::Map<const Eigen::Vector3f>(from.center),
               Eigen::Map<const Eigen::Vector3f>(from.half_extents), from.link, 0};
    if (from.link >= 0) return to;
    const Leaf leaf = leaves_[-1 - from.link];
    to.first = leaf.first;
    to.count = leaf.count;
    return to;
}

}  // namespace palpate::collision
