// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace palpate {

/// Most levels below the root, by which traversals size their stacks; a tree over 352 000 triangles has 21.
inline constexpr int deepest_obb_tree = 120;

/// Most triangles in a leaf: queries look at a leaf's triangles one by one in workspaces of fixed size.
inline constexpr std::int32_t most_leaf_triangles = 16;

/// One oriented box, in the order the tick reads it. A point p is inside when |axes * (p - center)| <=
/// half_extents in every component.
struct ObbNode {
    Eigen::Matrix3f axes;          ///< rows: the box's unit axes in P
    Eigen::Vector3f center;        ///< p_P, mm
    Eigen::Vector3f half_extents;  ///< mm, along the rows of `axes`, padded so that float32 encloses double
    std::int32_t first = 0;  ///< inner node: index of the left child, the right one follows it directly;
                             ///< leaf: first entry of triangle_order
    std::int32_t count = 0;  ///< 0 for an inner node; number of triangles for a leaf
};

/// A binary tree of oriented bounding boxes over a triangle mesh (Gottschalk, Lin, Manocha 1996). Node 0 is
/// the root; siblings are neighbours in memory; children come after their parent.
struct ObbTree {
    std::vector<ObbNode> nodes;
    std::vector<std::int32_t> triangle_order;  ///< a permutation of the mesh's triangles, leaf by leaf
};

}  // namespace palpate
