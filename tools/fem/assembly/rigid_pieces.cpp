// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/fem/assembly/rigid_pieces.hpp"

#include <algorithm>
#include <array>

#include "formats/model/disjoint_sets.hpp"

namespace palpate::fem {
namespace {

using Eigen::Vector3d;

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
        if (faces[i].nodes == faces[i - 1].nodes) sets.join(faces[i].tetrahedron, faces[i - 1].tetrahedron);
    return sets.numbered();
}

std::vector<Joint> joints_of(const TetMesh& mesh, const std::vector<std::size_t>& piece_of) {
    std::vector<std::vector<std::size_t>> pieces(mesh.rest_positions.size());
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
        for (const std::int32_t node : mesh.tetrahedra[t]) {
            auto& list = pieces[node];
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

std::vector<RigidPiece> pieces_of(const TetMesh& mesh, const std::vector<std::size_t>& piece_of,
                                  std::span<const std::int32_t> fixed_nodes) {
    std::vector<RigidPiece> pieces(std::ranges::max(piece_of) + 1);
    std::vector<std::pair<std::size_t, std::int32_t>> held;  // piece, fixed node
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
        ++pieces[piece_of[t]].tetrahedra;
        for (const std::int32_t node : mesh.tetrahedra[t]) {
            pieces[piece_of[t]].extent.extend(mesh.rest_positions[node]);
            if (std::ranges::binary_search(fixed_nodes, node)) held.emplace_back(piece_of[t], node);
        }
    }
    std::ranges::sort(held);
    held.erase(std::unique(held.begin(), held.end()), held.end());
    for (const auto& [piece, node] : held) pieces[piece].fixed.push_back(node);
    return pieces;
}

// Joins pieces that share three nodes off a line until no two do.
void join_locked_pieces(const TetMesh& mesh, std::vector<std::size_t>& piece_of) {
    for (bool joined = true; joined;) {
        joined = false;
        const auto pieces = pieces_of(mesh, piece_of, {});
        DisjointSets sets(pieces.size());
        for (const auto& [pair, nodes] : shared_nodes(joints_of(mesh, piece_of))) {
            const double size = std::min(pieces[pair.first].size(), pieces[pair.second].size());
            if (span_of(positions_of(mesh, nodes), size) < 2) continue;
            sets.join(pair.first, pair.second);
            joined = true;
        }
        const auto number = sets.numbered();
        for (std::size_t& piece : piece_of) piece = number[piece];
    }
}

void mark_held(const TetMesh& mesh, Linkage& linkage) {
    for (bool changed = true; changed;) {
        changed = false;
        for (std::size_t i = 0; i < linkage.pieces.size(); ++i) {
            RigidPiece& piece = linkage.pieces[i];
            if (piece.held) continue;
            piece.held = span_of(positions_of(mesh, anchors_of(linkage, i)), piece.size()) >= 2;
            changed |= piece.held;
        }
    }
}

}  // namespace

Linkage linkage_of(const TetMesh& mesh, std::span<const std::int32_t> fixed_nodes) {
    auto piece_of = face_connected(mesh);
    join_locked_pieces(mesh, piece_of);
    Linkage linkage{pieces_of(mesh, piece_of, fixed_nodes), joints_of(mesh, piece_of)};
    mark_held(mesh, linkage);
    return linkage;
}

std::vector<std::int32_t> anchors_of(const Linkage& linkage, std::size_t piece) {
    std::vector<std::int32_t> nodes = linkage.pieces[piece].fixed;
    for (const Joint& joint : linkage.joints)
        if (std::ranges::binary_search(joint.pieces, piece) &&
            std::ranges::any_of(joint.pieces, [&](std::size_t other) { return linkage.pieces[other].held; }))
            nodes.push_back(joint.node);
    std::ranges::sort(nodes);
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    return nodes;
}

std::map<std::pair<std::size_t, std::size_t>, std::vector<std::int32_t>> shared_nodes(
    const std::vector<Joint>& joints) {
    std::map<std::pair<std::size_t, std::size_t>, std::vector<std::int32_t>> shared;
    for (const Joint& joint : joints)
        for (std::size_t i = 0; i < joint.pieces.size(); ++i)
            for (std::size_t j = 0; j < i; ++j)
                shared[{joint.pieces[j], joint.pieces[i]}].push_back(joint.node);
    return shared;
}

std::vector<Vector3d> positions_of(const TetMesh& mesh, const std::vector<std::int32_t>& nodes) {
    std::vector<Vector3d> points;
    for (const std::int32_t node : nodes) points.push_back(mesh.rest_positions[node]);
    return points;
}

Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> spread_of(const std::vector<Vector3d>& points) {
    Vector3d mean = Vector3d::Zero();
    for (const Vector3d& p : points) mean += p / static_cast<double>(points.size());
    Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
    for (const Vector3d& p : points) spread += (p - mean) * (p - mean).transpose();
    return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread);
}

int span_of(const std::vector<Vector3d>& points, double size) {
    if (points.empty()) return 0;
    const double negligible = 1e-12 * size * size;
    return static_cast<int>((spread_of(points).eigenvalues().array() > negligible).count());
}

}  // namespace palpate::fem
