// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "formats/model/triangle_mesh.hpp"

namespace palpate::collision {

/// A point of a tool's surface, in the mesh's frame.
struct ShellPoint {
    Eigen::Vector3f position = Eigen::Vector3f::Zero();  ///< mm
    /// Unit, outward: that of its triangle; at a sharp vertex the mean of its triangles', weighted by their
    /// angles.
    Eigen::Vector3f normal = Eigen::Vector3f::Zero();
};

constexpr std::size_t fewest_shell_points = 4, most_shell_points = std::size_t{1} << 20;

/// A tool's surface as points.
struct PointShell {
    std::vector<ShellPoint> points;
    /// How far the farthest of the surface's points that were tried, ten for each of the shell's, is from the
    /// shell's nearest, mm.
    double covering_radius = 0;
};

/// Chooses `count` points of a closed surface that leave no large gap. Sharp vertices, the angles of whose
/// triangles leave more than 30 degrees of a full turn, come first, the sharpest ahead, up to a quarter of
/// the count; then, one by one, the point of the surface that is farthest from those already chosen (Gonzalez
/// 1985). So any first points of a shell are a coarser shell, and no two but the sharp vertices are nearer to
/// each other than the covering radius, which with n points but the sharp vertices is at most twice the least
/// that n / 2 points could have. Points whose normals are more than 120 degrees apart, as those of a blade's
/// two sides, do not count as near. The same mesh and count give the same points. Farthest points are looked
/// for among 10 count of the surface, spread by area: so many to a triangle, by the sequence R2 within it
/// (Roberts, "The unreasonable effectiveness of quasirandom sequences", 2018). Throws InvalidInput if the
/// count is not within fewest_shell_points ... most_shell_points or the surface has no area. Vertices are
/// finite and triangles theirs (unchecked). Cost: O(m + count log count) for m triangles, half a second for
/// 50 000 points; not for the tick.
PointShell point_shell(const TriangleMesh& mesh, std::size_t count);

}  // namespace palpate::collision
