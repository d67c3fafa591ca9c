// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "formats/model/obb_tree.hpp"
#include "formats/model/triangle_mesh.hpp"
#include "runtime/collision/triangle_queries.hpp"

namespace palpate::collision {

/// The nearest surface point.
struct ClosestPoint {
    Eigen::Vector3d point = Eigen::Vector3d::Zero();        ///< p_P, mm
    Eigen::Vector3d barycentric = Eigen::Vector3d::Zero();  ///< weights of the triangle's vertices
    double distance = 0;                                    ///< mm
    std::int32_t triangle = 0;                              ///< index in the mesh
    std::int32_t slot = 0;  ///< position in the tree's order: the hint for the next query
    Feature feature = Feature::face;
};

/// The first touch of a moving sphere.
struct SweepContact {
    double fraction = 0;                               ///< of the way, 0 ... 1
    Eigen::Vector3d point = Eigen::Vector3d::Zero();   ///< touched point, p_P, mm
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< unit, from the point to the sphere's centre
    std::int32_t triangle = 0;                         ///< index in the mesh
    std::int32_t slot = 0;  ///< position in the tree's order: the hint for the next query
};

/// Whether a triangle that is touched at `fraction` of the way comes before the first one so far, whose slot
/// is negative if there is none. Of those touched at once it is the one of the lowest slot, in whatever order
/// they are asked.
inline bool comes_before(double fraction, std::int32_t slot, const SweepContact& first) noexcept {
    return first.slot < 0 || fraction < first.fraction || (fraction == first.fraction && slot < first.slot);
}

/// A disc that holds a triangle, and the triangle's plane. In float32, which rounds the disc's centre: the
/// plane passes `lift` above it, along the normal. A triangle of hardly any area has no plane that could hold
/// anything off: its normal is zero, and the disc a ball.
struct alignas(32) TriangleDisc {
    std::array<float, 3> centre;  ///< p_P, mm
    float radius;                 ///< mm, rounded up
    std::array<float, 3> normal;  ///< unit or zero
    float lift;                   ///< mm
};

/// A walk through the tree for what is near a point, which may take several ticks.
struct NearWalk {
    Eigen::Vector3f centre = Eigen::Vector3f::Zero();  ///< p_P, mm
    float reach = 0;                                   ///< mm; may shrink on the way
    float passed_over = 0;  ///< mm: whatever was passed over is at least as far from the centre
    std::size_t pending = 0;
    std::array<std::int32_t, deepest_obb_tree + 2> nodes;
};

/// A triangle surface ready for queries at 1 kHz: triangles lie in the order of the tree's leaves, tree nodes
/// fill one cache line each. Vertices are rounded once to float32 (1.5e-5 mm at 300 mm), the same for every
/// triangle that shares them, so the surface stays closed; every query then computes in double. All queries
/// are noexcept, thread-safe and realtime-safe: no allocation, a fixed stack.
class CollisionSurface {
  public:
    /// `name` is for messages. Throws InvalidInput if the tree was not built over this mesh or is deeper than
    /// the queries' stack. Linear in the mesh.
    CollisionSurface(const TriangleMesh& mesh, const ObbTree& tree, const std::string& name);

    /// Finds the surface point nearest to p (mm) within max_distance (mm); nullopt if there is none. `hint`:
    /// a slot from an earlier query nearby, -1 for none; it changes the cost, not the distance.
    std::optional<ClosestPoint> closest_point(const Eigen::Vector3d& p, double max_distance,
                                              std::int32_t hint = -1) const noexcept;

    /// Finds where a sphere of `radius` >= 0 (mm), its centre moving from `from` to `to`, first touches the
    /// surface. A triangle overlapped at the start counts, at fraction 0, only if the motion goes deeper into
    /// it.
    std::optional<SweepContact> sweep_sphere(const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                                             double radius, std::int32_t hint = -1) const noexcept;

    /// Writes the slots of the triangles within `radius` of segment a-b (mm) to `slots` and returns how many
    /// there are, which may be more than fit; the order is that of the tree. Boxes decide, so a few lie
    /// slightly farther.
    std::size_t slots_near(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double radius,
                           std::span<std::int32_t> slots) const noexcept;

    /// Begins to look for the triangles within `reach` of `centre`, mm.
    NearWalk walk_near(const Eigen::Vector3f& centre, float reach) const noexcept;
    /// Goes on to the next leaf that may hold a triangle within reach, over at most `nodes` nodes of the
    /// tree, which it counts down. Writes the leaf's slots to `slots`, first and count; false where there is
    /// none yet, because the walk is at its end (pending 0) or the nodes are used up.
    bool next_leaf(NearWalk& walk, int& nodes, std::array<std::int32_t, 2>& slots) const noexcept;

    /// Tells whether p (mm) is outside: whether p - q, q the nearest surface point, goes along
    /// pseudonormal(q). The surface must bound a solid (unchecked); its vertices may be as acute and its
    /// triangles as thin as they like. A point on the surface is not outside. Source: Baerentzen, Aanaes
    /// 2005.
    bool is_outside(const Eigen::Vector3d& p) const noexcept;
    /// The same where the surface point nearest to p is known.
    bool is_outside(const Eigen::Vector3d& p, const ClosestPoint& nearest) const noexcept {
        return pseudonormal(nearest.point).dot(p - nearest.point) > 0;
    }

    /// The published name of the same: -1 inside, +1 outside.
    int inside_or_outside(const Eigen::Vector3d& p) const noexcept { return is_outside(p) ? 1 : -1; }

    /// The unit normal of the triangle found, out of the surface; of a triangle without area, the
    /// pseudonormal at the point; zero if no triangle there has area.
    Eigen::Vector3d outward_normal(const ClosestPoint& found) const noexcept;

    /// The angle-weighted normal at a surface point q (mm), unit: sum of alpha_t n_t over the triangles t
    /// that hold q, where alpha_t is the angle of the part of t about q: 2 pi on its face, pi on an edge, the
    /// corner's angle at a corner. Zero if no triangle with area holds q. Source: Baerentzen, Aanaes 2005.
    Eigen::Vector3d pseudonormal(const Eigen::Vector3d& q) const noexcept;

    std::int32_t triangle_count() const noexcept { return static_cast<std::int32_t>(triangles_.size()); }
    std::int32_t mesh_triangle(std::int32_t slot) const noexcept { return triangles_[slot].mesh_triangle; }
    /// The corners of a slot's triangle, mm.
    TriangleCorners corners(std::int32_t slot) const noexcept;
    const TriangleDisc& disc(std::int32_t slot) const noexcept { return discs_[slot]; }
    /// A node of the tree, 0 being the root, for queries that walk it themselves. As ObbTree says, but
    /// `first` of a leaf is a slot, and the box holds its triangles though axes are unit and square only to
    /// float32.
    ObbNode node(std::int32_t index) const noexcept;

  private:
    struct FlatTriangle {
        float corners[9];
        std::int32_t mesh_triangle;
    };
    struct alignas(64) Node {
        float axes[9];  // column-major: column k is what coordinate k adds along the box's three axes
        float center[3];
        float half_extents[3];
        std::int32_t link;  // inner: index of the left child; leaf: -1 - index into leaves_
    };
    struct Leaf {
        std::int32_t first;
        std::int32_t count;
    };

    void take_nodes(const ObbTree& tree, double scale, const std::string& name);
    struct Reach;
    static float squared_distance_bound(const Node& node, const Eigen::Vector3f& p) noexcept;
    static float squared_distance_bound(const Node& node, const Reach& reach) noexcept;

    std::vector<Node> nodes_;
    std::vector<Leaf> leaves_;
    std::vector<FlatTriangle> triangles_;
    std::vector<TriangleDisc> discs_;
};

}  // namespace palpate::collision
