// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/fem/rigid_motions.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <map>
#include <numeric>
#include <string>
#include <vector>

#include "formats/model/errors.hpp"

namespace palpate {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

class DisjointSets {
  public:
    explicit DisjointSets(std::size_t count) : parent_(count) {
        std::iota(parent_.begin(), parent_.end(), 0);
    }
    // The lowest member of a set stands for it.
    std::size_t root(std::size_t i) {
        while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
        return i;
    }
    void unite(std::size_t a, std::size_t b) {
        a = root(a), b = root(b);
        parent_[std::max(a, b)] = std::min(a, b);
    }
    // A number for each member's set, counted from 0 in the order of their lowest members.
    std::vector<std::size_t> numbered() {
        std::vector<std::size_t> number(parent_.size());
        std::size_t count = 0;
        for (std::size_t i = 0; i < parent_.size(); ++i) number[i] = root(i) == i ? count++ : number[root(i)];
        return number;
    }

  private:
    std::vector<std::size_t> parent_;
};

// What moves as one.
struct Piece {
    std::size_t tetrahedra = 0;
    Eigen::AlignedBox3d extent;
    std::vector<std::int32_t> fixed;  // nodes
    bool held = false;

    double size() const { return extent.diagonal().norm(); }
};

// A node at which pieces meet; they are listed ascending.
struct Joint {
    std::int32_t node;
    std::vector<std::size_t> pieces;
};

// How far points spread in three directions square to each other, ascending, mm².
Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> spread_of(const std::vector<Vector3d>& points) {
    Vector3d mean = Vector3d::Zero();
    for (const Vector3d& p : points) mean += p / static_cast<double>(points.size());
    Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
    for (const Vector3d& p : points) spread += (p - mean) * (p - mean).transpose();
    return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread);
}

// Directions of what points hold of a body of this size: 0 for none or one point, 1 on a line, 2 or 3.
int span_of(const std::vector<Vector3d>& points, double size) {
    if (points.empty()) return 0;
    const double negligible = 1e-12 * size * size;  // points within a millionth of the size fix no direction
    return static_cast<int>((spread_of(points).eigenvalues().array() > negligible).count());
}

std::vector<Vector3d> positions(const TetMesh& mesh, const std::vector<std::int32_t>& nodes) {
    std::vector<Vector3d> points;
    for (const std::int32_t node : nodes)
        points.push_back(mesh.rest_positions[static_cast<std::size_t>(node)]);
    return points;
}

// The number of each tetrahedron's piece, tetrahedra with a common face being in one.
std::vector<std::size_t> face_connected(const TetMesh& mesh) {
    struct Face {
        std::array<std::int32_t, 3> nodes;
        std::size_t tetrahedron;
    };
    std::vector<Face> faces;
    faces.reserve(4 * mesh.tetrahedra.size());
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
        for (const auto& corners : tetrahedron_faces) {
            Face face{{}, t};
            for (std::size_t c = 0; c < 3; ++c) face.nodes[c] = mesh.tetrahedra[t][corners[c]];
            std::ranges::sort(face.nodes);
            faces.push_back(face);
        }
    std::ranges::sort(faces, {}, &Face::nodes);
    DisjointSets sets(mesh.tetrahedra.size());
    for (std::size_t i = 1; i < faces.size(); ++i)
        if (faces[i].nodes == faces[i - 1].nodes) sets.unite(faces[i].tetrahedron, faces[i - 1].tetrahedron);
    return sets.numbered();
}

std::vector<Joint> joints_of(const TetMesh& mesh, const std::vector<std::size_t>& piece_of) {
    std::vector<std::vector<std::size_t>> pieces(mesh.rest_positions.size());
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
        for (const std::int32_t node : mesh.tetrahedra[t]) {
            auto& list = pieces[static_cast<std::size_t>(node)];
            if (std::ranges::find(list, piece_of[t]) == list.end()) list.push_back(piece_of[t]);
        }
    std::vector<Joint> joints;
    for (std::size_t node = 0; node < pieces.size(); ++node) {
        if (pieces[node].size() < 2) continue;
        std::ranges::sort(pieces[node]);
        joints.push_back({static_cast<std::int32_t>(node), std::move(pieces[node])});
    }
    return joints;
}

std::vector<Piece> pieces_of(const TetMesh& mesh, const std::vector<std::size_t>& piece_of,
                             std::span<const std::int32_t> fixed_nodes) {
    std::vector<Piece> pieces(std::ranges::max(piece_of) + 1);
    std::vector<std::pair<std::size_t, std::int32_t>> held;  // piece, fixed node
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
        ++pieces[piece_of[t]].tetrahedra;
        for (const std::int32_t node : mesh.tetrahedra[t]) {
            pieces[piece_of[t]].extent.extend(mesh.rest_positions[static_cast<std::size_t>(node)]);
            if (std::ranges::binary_search(fixed_nodes, node)) held.emplace_back(piece_of[t], node);
        }
    }
    std::ranges::sort(held);
    held.erase(std::unique(held.begin(), held.end()), held.end());
    for (const auto& [piece, node] : held) pieces[piece].fixed.push_back(node);
    return pieces;
}

using Pair = std::pair<std::size_t, std::size_t>;

// The nodes that pieces share, pair by pair.
std::map<Pair, std::vector<std::int32_t>> shared_nodes(const std::vector<Joint>& joints) {
    std::map<Pair, std::vector<std::int32_t>> shared;
    for (const Joint& joint : joints)
        for (std::size_t i = 0; i < joint.pieces.size(); ++i)
            for (std::size_t j = 0; j < i; ++j)
                shared[{joint.pieces[j], joint.pieces[i]}].push_back(joint.node);
    return shared;
}

// Joins pieces that share three nodes off a line until no two do.
void join_locked_pieces(const TetMesh& mesh, std::vector<std::size_t>& piece_of) {
    for (bool joined = true; joined;) {
        joined = false;
        const auto pieces = pieces_of(mesh, piece_of, {});
        DisjointSets sets(pieces.size());
        for (const auto& [pair, nodes] : shared_nodes(joints_of(mesh, piece_of))) {
            const double size = std::min(pieces[pair.first].size(), pieces[pair.second].size());
            if (span_of(positions(mesh, nodes), size) < 2) continue;
            sets.unite(pair.first, pair.second);
            joined = true;
        }
        const auto number = sets.numbered();
        for (std::size_t& piece : piece_of) piece = number[piece];
    }
}

// A piece's fixed nodes and those that it shares with held pieces.
std::vector<std::int32_t> anchors_of(std::size_t piece, const std::vector<Piece>& pieces,
                                     const std::vector<Joint>& joints) {
    std::vector<std::int32_t> nodes = pieces[piece].fixed;
    for (const Joint& joint : joints)
        if (std::ranges::binary_search(joint.pieces, piece) &&
            std::ranges::any_of(joint.pieces, [&](std::size_t other) { return pieces[other].held; }))
            nodes.push_back(joint.node);
    std::ranges::sort(nodes);
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    return nodes;
}

void mark_held(const TetMesh& mesh, std::vector<Piece>& pieces, const std::vector<Joint>& joints) {
    for (bool changed = true; changed;) {
        changed = false;
        for (std::size_t i = 0; i < pieces.size(); ++i) {
            if (pieces[i].held) continue;
            pieces[i].held = span_of(positions(mesh, anchors_of(i, pieces, joints)), pieces[i].size()) >= 2;
            changed |= pieces[i].held;
        }
    }
}

// The velocity of a piece's point under its six rigid motions: v = t + w x r with r in units of the piece's
// size.
Eigen::Matrix<double, 3, 6> motion_at(const Piece& piece, const Vector3d& point) {
    const Vector3d r = (point - piece.extent.center()) / piece.size();
    Eigen::Matrix<double, 3, 6> motion;
    motion.leftCols<3>().setIdentity();
    for (int axis = 0; axis < 3; ++axis) motion.col(3 + axis) = Vector3d::Unit(axis).cross(r);
    return motion;
}

// Those of the pieces that are not held which move in some common rigid motion: anchors stand still, and at a
// joint all pieces have one velocity.
std::vector<std::size_t> moving_pieces(const TetMesh& mesh, const std::vector<Piece>& pieces,
                                       const std::vector<Joint>& joints) {
    std::vector<std::size_t> loose;
    for (std::size_t i = 0; i < pieces.size(); ++i)
        if (!pieces[i].held) loose.push_back(i);
    constexpr std::size_t most_solved = 100;
    if (loose.empty() || loose.size() >= most_solved) return loose;

    const auto n = static_cast<Index>(6 * loose.size());
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(n, n);
    // Each connection weighs the same, however many nodes it has.
    const auto constrain = [&](const std::vector<std::int32_t>& nodes, const std::vector<std::size_t>& of) {
        for (const Vector3d& point : positions(mesh, nodes)) {
            Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(3, n);
            for (std::size_t k = 0; k < of.size(); ++k)
                rows.middleCols<6>(static_cast<Index>(6 * of[k])) =
                    (k == 0 ? 1.0 : -1.0) * motion_at(pieces[loose[of[k]]], point);
            normal += rows.transpose() * rows / static_cast<double>(nodes.size());
        }
    };
    for (std::size_t k = 0; k < loose.size(); ++k) constrain(anchors_of(loose[k], pieces, joints), {k});
    for (const auto& [pair, nodes] : shared_nodes(joints)) {
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
std::string motion_text(const TetMesh& mesh, const Piece& piece, const std::vector<std::int32_t>& anchors,
                        bool hangs) {
    const std::vector<Vector3d> points = positions(mesh, anchors);
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

[[noreturn]] void refuse(const TetMesh& mesh, std::size_t moving, const std::vector<Piece>& pieces,
                         const std::vector<Joint>& joints) {
    const Piece& piece = pieces[moving];
    const std::vector<std::int32_t> anchors = anchors_of(moving, pieces, joints);
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
    else if (pieces.size() > 1)
        next_step =
            "leave the part out ('palpate segment --keep-largest'), or hold it too, such as with "
            "--fixed sphere:x,y,z,r";
    throw InvalidInput(
        {pieces.size() == 1 ? "the body" : part,
         motion_text(mesh, piece, anchors, hangs) + ", so its stiffness is singular",
         hangs ? "a face in common with what holds it" : "3 or more held nodes that are not on a line",
         next_step});
}

void require_that_every_node_is_used(const TetMesh& mesh, std::span<const std::int32_t> fixed_nodes) {
    std::vector<bool> used(mesh.rest_positions.size(), false);
    for (const Tetrahedron& tet : mesh.tetrahedra)
        for (const std::int32_t node : tet) used[static_cast<std::size_t>(node)] = true;
    for (const std::int32_t node : fixed_nodes) used[static_cast<std::size_t>(node)] = true;
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
    auto piece_of = face_connected(mesh);
    join_locked_pieces(mesh, piece_of);
    auto pieces = pieces_of(mesh, piece_of, fixed_nodes);
    const auto joints = joints_of(mesh, piece_of);
    mark_held(mesh, pieces, joints);
    const auto moving = moving_pieces(mesh, pieces, joints);
    if (moving.empty()) return;
    for (std::size_t i = 0; i < pieces.size(); ++i) pieces[i].held = !std::ranges::binary_search(moving, i);
    // The part with the most anchors is nearest to what holds, so its hinge is the one to mend first.
    const auto anchorage = [&](std::size_t i) {
        const auto points = positions(mesh, anchors_of(i, pieces, joints));
        return points.empty() ? -1 : span_of(points, pieces[i].size());
    };
    refuse(mesh, *std::ranges::max_element(moving, {}, anchorage), pieces, joints);
}

}  // namespace palpate
