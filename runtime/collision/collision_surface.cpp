// SPDX-License-Identifier: Apache-2.0
#include "runtime/collision/collision_surface.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "formats/model/errors.hpp"

namespace palpate::collision {
namespace {

using Eigen::Vector3d;

[[noreturn]] void refuse(const std::string& name, const std::string& found, const std::string& expected) {
    throw InvalidInput({.culprit = name,
                        .found = found,
                        .expected = expected,
                        .next_step = "build the OBB tree again with 'palpate obb'"});
}

// The smallest ball around a triangle has its centre in the circumcentre, or in the longest edge's middle
// where the triangle is obtuse.
Vector3d middle_of(const TriangleCorners& t) {
    const double aa = (t[1] - t[2]).squaredNorm(), bb = (t[2] - t[0]).squaredNorm(),
                 cc = (t[0] - t[1]).squaredNorm();
    const double at_a = bb + cc - aa, at_b = cc + aa - bb, at_c = aa + bb - cc;
    if (at_a > 0 && at_b > 0 && at_c > 0) {
        const double wa = aa * at_a, wb = bb * at_b, wc = cc * at_c;
        return (wa * t[0] + wb * t[1] + wc * t[2]) / (wa + wb + wc);
    }
    if (aa >= bb && aa >= cc) return 0.5 * (t[1] + t[2]);
    return bb >= cc ? 0.5 * (t[2] + t[0]) : 0.5 * (t[0] + t[1]);
}

// Fits radius, normal and lift to the centre as it was rounded: read back from memory, for GCC 12 takes two
// lanes of a rounding to float32 and back for none.
void fit(TriangleDisc& disc, const TriangleCorners& t) {
    const Vector3d centre = Eigen::Map<const Eigen::Vector3f>(disc.centre.data()).cast<double>();
    double radius = 0;
    for (const Vector3d& corner : t) radius = std::max(radius, (corner - centre).norm());
    const Vector3d cross = (t[1] - t[0]).cross(t[2] - t[0]);
    const double twice_area = cross.norm();
    const Vector3d normal =
        twice_area > 0.1 * radius * radius ? Vector3d(cross / twice_area) : Vector3d::Zero();
    Eigen::Map<Eigen::Vector3f>(disc.normal.data()) = normal.cast<float>();
    disc.radius = std::nextafter(static_cast<float>(radius), std::numeric_limits<float>::max());
    disc.lift = static_cast<float>(normal.dot(t[0] - centre));
}

}  // namespace

CollisionSurface::CollisionSurface(const TriangleMesh& mesh, const ObbTree& tree, const std::string& name) {
    const std::size_t count = mesh.triangles.size();
    if (count == 0) refuse(name, "the surface has no triangles", "");
    if (tree.triangle_order.size() != count)
        refuse(name, "the OBB tree orders " + std::to_string(tree.triangle_order.size()) + " triangles",
               std::to_string(count));

    triangles_.resize(count);
    std::vector<bool> taken(count, false);
    const auto vertex_count = static_cast<std::int32_t>(mesh.vertices.size());
    double scale = 0;  // mm, largest coordinate
    for (std::size_t slot = 0; slot < count; ++slot) {
        const std::int32_t t = tree.triangle_order[slot];
        if (t < 0 || static_cast<std::size_t>(t) >= count || taken[t])
            refuse(name, "entry " + std::to_string(slot) + " of the OBB tree's order is " + std::to_string(t),
                   "each triangle once");
        taken[t] = true;
        triangles_[slot].mesh_triangle = t;
        const Triangle& corners = mesh.triangles[t];
        for (std::size_t corner = 0; corner < 3; ++corner) {
            if (corners[corner] < 0 || corners[corner] >= vertex_count)
                refuse(name,
                       "triangle " + std::to_string(t) + " names vertex " + std::to_string(corners[corner]),
                       "0 to " + std::to_string(vertex_count - 1));
            const Eigen::Vector3d& vertex = mesh.vertices[corners[corner]];
            for (std::size_t axis = 0; axis < 3; ++axis)
                triangles_[slot].corners[3 * corner + axis] =
                    static_cast<float>(vertex[static_cast<Eigen::Index>(axis)]);
            scale = std::max(scale, vertex.cwiseAbs().maxCoeff());
        }
    }
    discs_.resize(count);
    for (std::size_t slot = 0; slot < count; ++slot)
        Eigen::Map<Eigen::Vector3f>(discs_[slot].centre.data()) =
            middle_of(corners(static_cast<std::int32_t>(slot))).cast<float>();
    for (std::size_t slot = 0; slot < count; ++slot)
        fit(discs_[slot], corners(static_cast<std::int32_t>(slot)));
    take_nodes(tree, scale, name);
}

void CollisionSurface::take_nodes(const ObbTree& tree, double scale, const std::string& name) {
    // Float32 rounding of vertices, query point, centre and axes: a few units in the last place of the scale.
    const auto padding = static_cast<float>(8 * 6e-8 * scale);
    const std::size_t count = tree.nodes.size();
    nodes_.resize(count);
    std::vector<int> depth(count, -1);
    if (count > 0) depth[0] = 0;
    std::size_t covered = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const ObbNode& from = tree.nodes[i];
        Node& to = nodes_[i];
        Eigen::Map<Eigen::Matrix3f>(to.axes) = from.axes;
        Eigen::Map<Eigen::Vector3f>(to.center) = from.center;
        Eigen::Map<Eigen::Vector3f>(to.half_extents) = from.half_extents.array() + padding;
        if (depth[i] < 0)
            refuse(name, "node " + std::to_string(i) + " of the OBB tree has no parent before it", "");
        if (depth[i] > deepest_obb_tree)
            refuse(name, "the OBB tree is deeper than " + std::to_string(deepest_obb_tree) + " levels", "");
        const auto first = static_cast<std::size_t>(from.first);
        if (from.count > 0) {
            if (from.first < 0 || first + static_cast<std::size_t>(from.count) > triangles_.size())
                refuse(name, "leaf " + std::to_string(i) + " of the OBB tree leaves the order", "");
            covered += static_cast<std::size_t>(from.count);
            to.link = -1 - static_cast<std::int32_t>(leaves_.size());
            leaves_.push_back({from.first, from.count});
        } else {
            if (from.count < 0 || from.first < 0 || first <= i || first + 1 >= count || depth[first] >= 0)
                refuse(name,
                       "node " + std::to_string(i) + " of the OBB tree names child " + std::to_string(first),
                       "a later node without a parent");
            depth[first] = depth[first + 1] = depth[i] + 1;
            to.link = from.first;
        }
    }
    if (covered != triangles_.size())
        refuse(name, "the leaves of the OBB tree hold " + std::to_string(covered) + " triangles",
               std::to_string(triangles_.size()));
}

}  // namespace palpate::collision
