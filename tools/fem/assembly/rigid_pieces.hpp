// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "formats/model/tet_mesh.hpp"

namespace palpate::fem {

/// Tetrahedra of a mesh that have no rigid motion against each other.
struct RigidPiece {
    std::size_t tetrahedra = 0;
    Eigen::AlignedBox3d extent;       ///< LPS mm
    std::vector<std::int32_t> fixed;  ///< its fixed nodes, ascending
    bool held = false;                ///< by its fixed nodes and those that it shares with held pieces

    double size() const { return extent.diagonal().norm(); }
};

/// A node at which pieces meet; they are listed ascending.
struct Joint {
    std::int32_t node;
    std::vector<std::size_t> pieces;
};

/// The pieces that a mesh falls into and where they meet.
struct Linkage {
    std::vector<RigidPiece> pieces;
    std::vector<Joint> joints;  ///< ascending by node
};

/// Finds a mesh's pieces: tetrahedra with a common face are in one piece, and so are pieces that share three
/// nodes off a line. Marks a piece as held if its anchors are not on a line, as often as that holds further
/// ones. Cost: sorts 4 faces a tetrahedron.
Linkage linkage_of(const TetMesh& mesh, std::span<const std::int32_t> fixed_nodes);

/// Returns a piece's fixed nodes and those that it shares with held pieces, ascending.
std::vector<std::int32_t> anchors_of(const Linkage& linkage, std::size_t piece);

/// Returns the nodes that any two pieces share, by pair, the lower piece first.
std::map<std::pair<std::size_t, std::size_t>, std::vector<std::int32_t>> shared_nodes(
    const std::vector<Joint>& joints);

/// Returns the positions of these nodes.
std::vector<Eigen::Vector3d> positions_of(const TetMesh& mesh, const std::vector<std::int32_t>& nodes);

/// Decomposes sum (p - mean)(p - mean)ᵀ, mm²: how far points spread in three directions square to each other,
/// ascending.
Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> spread_of(const std::vector<Eigen::Vector3d>& points);

/// Counts the directions in which points spread: 0 for none or one point, 1 on a line, 2 or 3. A spread
/// within a millionth of `size`, mm, counts as none.
int span_of(const std::vector<Eigen::Vector3d>& points, double size);

}  // namespace palpate::fem
