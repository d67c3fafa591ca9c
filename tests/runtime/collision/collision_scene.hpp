// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <random>

#include "formats/model/obb_tree.hpp"
#include "formats/model/triangle_mesh.hpp"
#include "runtime/collision/triangle_queries.hpp"

namespace palpate {

/// A point of a cube about the origin, evenly drawn, mm.
Eigen::Vector3d in_cube(double half_edge, std::mt19937& generator);

/// A tree of boxes along the axes of a rotated frame.
ObbTree tilted_tree(TriangleMesh surface, std::size_t leaf_size);

/// A closed sphere of 8 * 4^levels triangles far from the origin, with `loose` triangles about it, among them
/// needles, segments, points and triangles that lie on one another.
struct Scene {
    static const Eigen::Vector3d middle;  ///< mm
    TriangleMesh mesh;
    std::mt19937 generator{11};

    explicit Scene(int levels = 2, int loose = 90);
    /// Anywhere in a cube of edge 40 mm about the middle.
    Eigen::Vector3d point();
    /// Any of: a point, one far away, a corner, a point on an edge or a face, or one just above an edge.
    Eigen::Vector3d awkward_point(const collision::TriangleCorners& t);
};

/// A triangle with corners within 2 mm of `about`: any, a needle, a segment, a point, or one on a grid, so
/// that corners and edges of several meet.
collision::TriangleCorners awkward_triangle(const Eigen::Vector3d& about, std::mt19937& generator);

/// A closed surface that is star-shaped about the origin, with spikes up to eight times as far out as the
/// bottoms between them: acute corners and edges, outward and inward.
TriangleMesh spiky_ball(unsigned seed);

}  // namespace palpate
