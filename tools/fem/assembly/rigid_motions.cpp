// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/fem/assembly/rigid_motions.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <string>

#include "formats/model/errors.hpp"
#include "tools/fem/assembly/rigid_pieces.hpp"

namespace palpate::fem {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

// The velocity of a piece's point under its six rigid motions: v = t + w x r with r in units of the piece's
// size.
Eigen::Matrix<double, 3, 6> motion_at(const RigidPiece& piece, const Vector3d& point) {
    const Vector3d r = (point - piece.extent.center()) / piece.size();
    Eigen::Matrix<double, 3, 6> motion;
    motion.leftCols<3>().setIdentity();
    for (int axis = 0; axis < 3; ++axis) motion.col(3 + axis) = Vector3d::Unit(axis).cross(r);
    return motion;
}

// Those of the pieces that are not held which move in some common rigid motion: anchors stand still, and at a
// joint all pieces have one velocity.
std::vector<std::size_t> moving_pieces(const TetMesh& mesh, const Linkage& linkage) {
    const std::vector<RigidPiece>& pieces = linkage.pieces;
    std::vector<std::size_t> loose;
    for (std::size_t i = 0; i < pieces.size(); ++i)
        if (!pieces[i].held) loose.push_back(i);
    constexpr std::size_t most_solved = 100;
    if (loose.empty() || loose.size() >= most_solved) return loose;

    const auto n = static_cast<Index>(6 * loose.size());
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(n, n);
    // Each connection weighs the same, however many nodes it has.
    const auto constrain = [&](const std::vector<std::int32_t>& nodes, const std::vector<std::size_t>& of) {
        for (const Vector3d& point : positions_of(mesh, nodes)) {
            Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(3, n);
            for (std::size_t k = 0; k < of.size(); ++k)
                rows.middleCols<6>(static_cast<Index>(6 * of[k])) =
                    (k == 0 ? 1.0 : -1.0) * motion_at(pieces[loose[of[k]]], point);
            normal += rows.transpose() * rows / static_cast<double>(nodes.size());
        }
    };
    for (std::size_t k = 0; k < loose.size(); ++k) constrain(anchors_of(linkage, loose[k]), {k});
    for (const auto& [pair, nodes] : shared_nodes(linkage.joints)) {
        const auto first = std::ranges::lower_bound(loose, pair.first),
                   second = std::ranges::lower_bound(loose, pair.second);
        if (first == loose.end() || *first != pair.first || second == loose.end() || *second != pair.second)
            continue;
        constrain(nodes, {static_cast<std::size_t>(first - loose.begin()),
                          static_cast<std::size_t>(second - loose.begin())});
    }
    constexpr double still = 1e-12;  // squared, of velocities of a few units
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> modes(normal);
    std::vector<std::size_t> moving;
    for (std::size_t k = 0; k < loose.size(); ++k)
        for (Index mode = 0; mode < n && modes.eigenvalues()[mode] <= still; ++mode)
            if (modes.eigenvectors().col(mode).segment<6>(static_cast<Index>(6 * k)).norm() > 1e-6) {
                moving.push_back(loose[k]);
                break;
            }
    return moving;
}

std::string text_of(Vector3d p, int decimals) {
    const double unit = std::pow(10.0, decimals);
    for (double& x : p) x = std::round(x * unit) / unit + 0.0;  // never "-0"
    return fmt::format("({:.{}f}, {:.{}f}, {:.{}f})", p.x(), decimals, p.y(), decimals, p.z(), decimals);
}

// "17" or "17, 18 and 3 more".
std::string listed(const std::vector<std::int32_t>& nodes) {
    constexpr std::size_t shown = 3;
    std::string text;
    for (std::size_t i = 0; i < std::min(shown, nodes.size()); ++i)
        text += (i > 0 ? ", " : "") + std::to_string(nodes[i]);
    if (nodes.size() > shown) text += " and " + std::to_string(nodes.size() - shown) + " more";
    return text;
}

// The line that points lie on, as "(x, y, z) mm along (dx, dy, dz)".
std::string line_text(const std::vector<Vector3d>& points) {
    Vector3d direction = spread_of(points).eigenvectors().col(2);
    Index largest = 0;
    direction.cwiseAbs().maxCoeff(&largest);
    if (direction[largest] < 0) direction = -direction;
    return fmt::format("{} mm along {}", text_of(points.front(), 1), text_of(direction, 3));
}

// How a piece moves that its anchors do not hold. `hangs`: by nodes that it shares with other pieces.
std::string motion_text(const TetMesh& mesh, const RigidPiece& piece,
                        const std::vector<std::int32_t>& anchors, bool hangs) {
    const std::vector<Vector3d> points = positions_of(mesh, anchors);
    if (points.empty()) return "can translate and rotate freely: no node is held";
    const bool line = span_of(points, piece.size()) == 1;
    const std::string place = line ? line_text(points) : text_of(points.front(), 1) + " mm";
    if (hangs)
        return fmt::format("hangs by {} {} only and can rotate about {} {}",
                           anchors.size() > 1 ? "nodes" : "node", listed(anchors),
                           line ? "their line, through" : "it, at", place);
    return fmt::format("can rotate about {} {}",
                       line ? "the line of its held nodes, through" : "its only held point", place);
}

[[noreturn]] void refuse(const TetMesh& mesh, const Linkage& linkage, std::size_t moving) {
    const RigidPiece& piece = linkage.pieces[moving];
    const bool alone = linkage.pieces.size() == 1;
    const std::vector<std::int32_t> anchors = anchors_of(linkage, moving);
    const bool hangs = anchors.size() > piece.fixed.size();
    const Vector3d sizes = piece.extent.sizes();
    const std::string part =
        fmt::format("its part of {} tetrahedra around {} mm, {:.1f} x {:.1f} x {:.1f} mm", piece.tetrahedra,
                    text_of(piece.extent.center(), 0), sizes.x(), sizes.y(), sizes.z());
    std::string next_step = "add a rule such as --fixed touching:LABEL or --fixed sphere:x,y,z,r";
    if (hangs)
        next_step =
            "mesh it without the hinge (finer, or from labels without the thin bridge), leave the part out, "
            "or hold it too, such as with --fixed sphere:x,y,z,r";
    else if (!alone)
        next_step =
            "leave the part out ('palpate segment --keep-largest'), or hold it too, such as with "
            "--fixed sphere:x,y,z,r";
    throw InvalidInput(
        {alone ? "the body" : part,
         motion_text(mesh, piece, anchors, hangs) + ", so its stiffness is singular",
         hangs ? "a face in common with what holds it" : "3 or more held nodes that are not on a line",
         next_step});
}

void require_that_every_node_is_used(const TetMesh& mesh, std::span<const std::int32_t> fixed_nodes) {
    std::vector<bool> used(mesh.rest_positions.size(), false);
    for (const Tetrahedron& tet : mesh.tetrahedra)
        for (const std::int32_t node : tet) used[node] = true;
    for (const std::int32_t node : fixed_nodes) used[node] = true;
    const auto unused = std::ranges::find(used, false);
    if (unused != used.end())
        throw InvalidInput({"node " + std::to_string(unused - used.begin()),
                            "belongs to no tetrahedron, so nothing holds it", "", "remove it from the mesh"});
}

}  // namespace

void require_no_rigid_motion(const TetMesh& mesh, std::span<const std::int32_t> fixed_nodes) {
    if (mesh.tetrahedra.empty())
        throw InvalidInput({"the body", "has no tetrahedra", "1 or more", "mesh it"});
    require_that_every_node_is_used(mesh, fixed_nodes);
    Linkage linkage = linkage_of(mesh, fixed_nodes);
    const auto moving = moving_pieces(mesh, linkage);
    if (moving.empty()) return;
    // What locks each other holds as well as what is held.
    for (std::size_t i = 0; i < linkage.pieces.size(); ++i)
        linkage.pieces[i].held = !std::ranges::binary_search(moving, i);
    // The part with the most anchors is nearest to what holds, so its hinge is the one to mend first.
    const auto anchorage = [&](std::size_t i) {
        const auto points = positions_of(mesh, anchors_of(linkage, i));
        return points.empty() ? -1 : span_of(points, linkage.pieces[i].size());
    };
    refuse(mesh, linkage, *std::ranges::max_element(moving, {}, anchorage));
}

}  // namespace palpate::fem
