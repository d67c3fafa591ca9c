// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "formats/model/triangle_mesh.hpp"

namespace palpate::haptics {

/// One of the spheres that stand for a tool, in its frame T.
struct ToolSphere {
    Eigen::Vector3d centre{0, 0, 0};  ///< mm
    double radius = 0;                ///< mm
};

/// Spheres inside a closed surface that come as near to it as so many can.
struct SphereFilling {
    std::vector<ToolSphere> spheres;
    double largest_gap = 0;  ///< mm: the farthest of the surface's points that were tried from all spheres
};

/// Fills a tool with `most` spheres at most. Candidates are the largest spheres inside that touch the surface
/// at points all over it (Ma, Bae, Choi 2012, "3D medial axis point approximation using nearest neighbors and
/// the normal field"); of these the one comes next that takes most off the squares of the points' distances
/// from the spheres chosen so far, but none that touches a plane next to another, and a twentieth of a
/// sphere's radius is no distance: a ball of facets is one sphere. Points near the origin, the tip's centre,
/// count more: one at 25 mm from it half as much. No sphere goes through a triangle; none is smaller
/// than a tenth of a millimetre. The same surface gives the same spheres. Throws InvalidInput if the surface
/// has no area, or no such sphere inside. Triangles look outward (unchecked). Cost: half a second; not for
/// the tick.
SphereFilling fill_with_spheres(const TriangleMesh& surface, std::size_t most);

/// A ball of `radius` at the origin and, where it has a shaft, as many along +z up to `length` as make its
/// surface dip by an eighth of the radius, `most` at most; mm.
std::vector<ToolSphere> rod_spheres(double radius, double length, std::size_t most);

}  // namespace palpate::haptics
