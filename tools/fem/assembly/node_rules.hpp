// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "formats/model/body.hpp"

namespace palpate::fem {

/// Surface nodes beyond which lies the label of this name; "background" means no label.
struct TouchingLabel {
    std::string name;
};
/// Surface nodes inside an axis-parallel box, LPS mm.
struct InsideBox {
    Eigen::Vector3d lower, upper;
};
/// Surface nodes inside a sphere, LPS mm.
struct InsideSphere {
    Eigen::Vector3d center;
    double radius;
};
/// Surface nodes on the side of a plane that its normal points to, LPS mm.
struct BeyondPlane {
    Eigen::Vector3d point, normal;
};
/// Surface nodes at which the surface looks within 45 degrees of a direction, LPS, by its triangles' area.
struct Facing {
    Eigen::Vector3d direction;
};
/// Surface nodes that are corners of a region's tetrahedra; a region by name or value.
struct OfRegion {
    std::string name;
};
/// The mesh nodes listed in a text file: one index a line, counted from 0; '#' begins a comment.
struct ListedNodes {
    std::filesystem::path file;
};

/// What picks nodes of a mesh, to hold them or to let them be touched.
struct NodeRule {
    std::string text;  ///< as it was given, such as "--fixed sphere:0,0,0,5"; errors name it
    std::variant<TouchingLabel, InsideBox, InsideSphere, BeyondPlane, Facing, OfRegion, ListedNodes> pick;
};

/// The grammar of parse_node_rule(), for the help of commands.
inline constexpr std::string_view node_rule_grammar =
    "touching:LABEL (what lies beyond the surface; 'background' for none), region:NAME, "
    "box:x0,y0,z0,x1,y1,z1, sphere:x,y,z,r, plane:x,y,z,nx,ny,nz (the side its normal points to), "
    "facing:nx,ny,nz (where the surface looks that way within 45 degrees), nodes:FILE (text, one node index "
    "a line, counted from 0, '#' for comments)";

/// Reads a rule of `option`, "--fixed" or "--contact", in the words of node_rule_grammar; positions and
/// radius are LPS mm. Throws UsageError naming the rule for an unknown kind, a number that is not
/// finite, a wrong count of numbers, a box turned inside out, a radius that is not positive, a normal of no
/// length.
NodeRule parse_node_rule(std::string_view option, std::string_view text);

/// The same rules from numbers: x0, y0, z0, x1, y1, z1 of a box; x, y, z, r of a sphere; x, y, z, nx, ny, nz
/// of a plane; nx, ny, nz that the surface looks along. Throw as parse_node_rule() does.
NodeRule box_rule(std::string_view option, const std::vector<double>& corners);
NodeRule sphere_rule(std::string_view option, const std::vector<double>& center_and_radius);
NodeRule plane_rule(std::string_view option, const std::vector<double>& point_and_normal);
NodeRule facing_rule(std::string_view option, const std::vector<double>& direction);

/// Returns the nodes that any rule picks, ascending: surface nodes, and interior ones where a file lists
/// them. Throws InvalidInput if a rule names an unknown label or region (with the nearest names), picks no
/// node, or its file cannot be read or holds something else than a node's index (with file, line and value).
/// Cost: one pass over the surface nodes per rule.
std::vector<std::int32_t> fixed_nodes_of(const TetMesh& mesh, const BoundarySurface& boundary,
                                         std::span<const NodeRule> rules);

/// Returns the surface nodes that any rule picks and that are not fixed, ascending; with no rule every free
/// surface node. Throws InvalidInput as fixed_nodes_of() does, and if a file lists an interior node or every
/// picked node is fixed.
std::vector<std::int32_t> contact_nodes_of(const TetMesh& mesh, const BoundarySurface& boundary,
                                           std::span<const NodeRule> rules,
                                           std::span<const std::int32_t> fixed_nodes);

/// Returns body.contact_nodes or, if there are none, every free surface node. Reads boundary, fixed_nodes and
/// contact_nodes. Throws InvalidInput naming the entry if the contact nodes are not ascending, not on the
/// surface, or fixed, and if no surface node is free.
std::vector<std::int32_t> contact_surface_of(const DeformableBody& body);

}  // namespace palpate::fem
