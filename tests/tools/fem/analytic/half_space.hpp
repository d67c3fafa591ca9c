// SPDX-License-Identifier: GPL-3.0-or-later
// A piece of the half-space z <= 0 that ends where Boussinesq's point force describes the rest.
#pragma once
#include "tests/tools/fem/analytic/elastic_system.hpp"

namespace palpate::test {

/// A cylinder below z = 0 whose rings and layers are 1/steps mm wide up to 1 mm and then grow in proportion
/// to their distance, to the radius and depth `end` mm or a little more; the whole disc, or its quarter with
/// x, y >= 0.
TetMesh half_space_mesh(int steps, double end, bool quarter);

/// True at the nodes on the far boundary of that mesh: its outermost ring and its lowest layer.
Condition on_far_boundary(const TetMesh& mesh);

/// True at the nodes of z = 0 within 1 mm of the axis.
bool on_pressed_disc(const Eigen::Vector3d& p);

}  // namespace palpate::test
