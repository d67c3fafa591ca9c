// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "formats/model/body.hpp"

namespace palpate::asset {

/// What must hold of values before they are written and after they were read: every index in range, every
/// number finite, all parts of one another. Each function throws InvalidInput whose culprit starts with
/// `where` (a file and the object in it).

/// mm from the origin on each axis: ten metres. float32 keeps 0.001 mm there, and no scanner is as large.
inline constexpr double farthest_coordinate = 1e4;

/// mm by which a triangle's corner may lie outside its box: float32 round-off of a box 1 m from the origin,
/// far below what a hand or a tool's radius could notice.
inline constexpr double farthest_escape = 1e-4;

/// mm by which a box may be larger than what it encloses, on either side: more only takes time of every tick.
inline constexpr double farthest_slack = 1;

/// Vertices within farthest_coordinate, at least one triangle, vertex indices in range. O(triangles).
void check_surface(const TriangleMesh& surface, const std::string& where);

/// The surface of a rigid body that check_surface() has passed is closed, its triangles agree about sides,
/// and it holds a volume: where they do not, its inside would be felt as outside. O(triangles).
void check_sides(const TriangleMesh& surface, const std::string& where);

/// A binary tree whose siblings are neighbours, children after parents, at most `deepest_obb_tree` levels;
/// boxes finite with orthonormal axes; leaves of at most `most_leaf_triangles` that share out all triangles,
/// each once. O(nodes + triangles).
void check_obb_tree(const ObbTree& tree, std::size_t triangle_count, const std::string& where);

/// Every box of a tree that check_obb_tree() has passed encloses the triangles of all leaves below it, within
/// farthest_escape, and is no larger than they are by more than farthest_slack. O(triangles x levels): 0.2 s
/// for 350 000.
void check_enclosure(const ObbTree& tree, const TriangleMesh& surface, const std::string& where);

/// A tree of blocks that covers the matrix once, within its values, all of them finite; an order that is a
/// permutation; a positive diagonal. `positions` is not looked at. O(values).
void check_hierarchical(const HierarchicalCompliance& compliance, const std::string& where);

/// Everything about an elastic body but its OBB tree, its boundary recomputed. O(tetrahedra log + entries of
/// the compliance).
void check_body(const DeformableBody& body, const std::string& where);

/// A stiffness for each surface vertex, finite, 0 where there is no contact node and not negative elsewhere;
/// regions of the body, ascending, each at a vertex that has the stiffness it says. O(vertices).
void check_feel(const Feel& feel, const DeformableBody& body, const std::string& where);

/// Settings in their ranges.
void check_haptics(const HapticSettings& haptics, const std::string& where);

/// A name that a person can read and a terminal can print: 1 to 255 bytes of UTF-8 without control characters
/// and without those that turn the direction of writing.
void check_name(const std::string& name, const std::string& where);

}  // namespace palpate::asset
