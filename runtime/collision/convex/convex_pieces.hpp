// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "runtime/collision/balls/ball_node.hpp"
#include "runtime/collision/features/surface_features.hpp"

namespace palpate::collision {

/// A part of a surface of pieces: a ball about its triangles, and which piece all of them belong to.
struct PieceNode : BallNode {
    std::int32_t piece = -1;  ///< -1: to several
};

/// A vertex of a piece, and one of the piece's triangles that have it as a corner.
struct PieceVertex {
    std::int32_t vertex = 0, triangle = 0;
    std::int16_t corner = 0;
    bool is_pointed = false;  ///< three faces or more meet in it, or it is at a border
};

/// One convex piece of a surface.
struct ConvexPiece {
    std::span<const std::int32_t> triangles;
    std::span<const PieceVertex> vertices;  ///< each once
    std::int32_t root = 0;                  ///< the node that holds all of its triangles and no others
};

/// A surface cut into convex pieces: connected triangles all of which lie on the convex hull of their
/// vertices, that is, none has a vertex of its piece before its plane (a convex surface decomposition:
/// Ehmann, Lin 2001, "Accurate and fast proximity queries between polyhedra using convex surface
/// decomposition"). Above the pieces, and in each down to its triangles, is a tree of balls.
class ConvexPieces {
  public:
    /// A piece grows to so many triangles at most, so that what is asked of all its vertices stays short.
    static constexpr std::size_t most_triangles = 256;
    /// How far before a triangle's plane a vertex of its piece may be, mm: what float32 makes of a flat face.
    static constexpr double flat_within = 1e-3;

    /// `features` must outlive this. Pieces grow from the first triangle that is in none, breadth first.
    /// Throws InvalidInput if there is no triangle. O(n (most_triangles + log n)).
    explicit ConvexPieces(const SurfaceFeatures& features);

    std::size_t count() const noexcept { return roots_.size(); }
    ConvexPiece piece(std::int32_t index) const noexcept {
        const auto i = static_cast<std::size_t>(index);
        return {part(triangles_, triangle_begin_, i), part(vertices_, vertex_begin_, i), roots_[i]};
    }
    std::int32_t piece_of(std::int32_t triangle) const noexcept {
        return piece_of_[static_cast<std::size_t>(triangle)];
    }
    const PieceNode& node(std::int32_t index) const noexcept {  ///< 0 is the root
        return nodes_[static_cast<std::size_t>(index)];
    }
    const SurfaceFeatures& features() const noexcept { return features_; }
    /// The farthest that any vertex is from the origin, mm.
    double longest_arm() const noexcept { return longest_arm_; }

  private:
    template <typename Item>
    static std::span<const Item> part(const std::vector<Item>& of, const std::vector<std::int32_t>& begin,
                                      std::size_t i) noexcept {
        const auto first = static_cast<std::size_t>(begin[i]), last = static_cast<std::size_t>(begin[i + 1]);
        return std::span(of).subspan(first, last - first);
    }

    const SurfaceFeatures& features_;
    std::vector<std::int32_t> piece_of_;                    // of each triangle
    std::vector<std::int32_t> triangle_begin_, triangles_;  // of each piece
    std::vector<std::int32_t> vertex_begin_;
    std::vector<PieceVertex> vertices_;
    std::vector<std::int32_t> roots_;
    std::vector<PieceNode> nodes_;
    double longest_arm_ = 0;
};

}  // namespace palpate::collision
