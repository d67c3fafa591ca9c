// SPDX-License-Identifier: GPL-3.0-or-later
// Tetrahedral meshes of the bodies whose exact solutions are known.
#pragma once
#include <Eigen/Core>
#include <array>
#include <functional>
#include <vector>

#include "formats/model/tet_mesh.hpp"

namespace palpate::test {

/// Triangles in a plane, whose points have coordinates without unit.
struct PlaneMesh {
    std::vector<Eigen::Vector2d> points;
    std::vector<std::array<std::int32_t, 3>> triangles;
};

/// The triangle (0,0) (1,0) (0,1) cut into n² triangles.
PlaneMesh cut_triangle(int n);

/// The square from (0,0) to (1,1) cut into 2 · along_u · along_v triangles.
PlaneMesh cut_square(int along_u, int along_v);

/// The disc, or its sector from angle 0 to `angle`, as rings of the given radii around the origin. A ring has
/// as many segments as its number, up to `most_segments`, in each of `sectors` equal sectors. An angle of 2
/// pi closes the disc.
PlaneMesh cut_disc(const std::vector<double>& radii, int sectors, double angle, int most_segments);

/// Sweeps a plane mesh through `layers` layers of prisms, three tetrahedra each, one region of value 1.
/// `place` maps a plane point and a layer's border (0 ... layers) to mm. Node (border, point) has number
/// border · points + point.
TetMesh sweep(const PlaneMesh& plane, int layers,
              const std::function<Eigen::Vector3d(const Eigen::Vector2d&, int border)>& place);

/// One octant of a shell between two spheres around the origin, mm; flat faces on x = 0, y = 0, z = 0.
TetMesh hollow_sphere_octant(double inner_radius, double outer_radius, int around, int through);

/// A quarter of a slice of tube around the z axis, mm; flat faces on x = 0, y = 0, z = 0 and z = thickness.
/// Layers through the wall grow with the radius.
TetMesh tube_quarter(double inner_radius, double outer_radius, double thickness, int around, int through);

}  // namespace palpate::test
