// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "formats/model/tet_mesh.hpp"

namespace palpate::meshing {

/// Adds `step`, mm, three rows a node, to the nodes' positions: halved, as often as it takes, at the nodes of
/// every tetrahedron that would turn over or get a dihedral angle nearer than `floor_deg` to 0° or 180° than
/// it had, and at those of boundary triangles that would be pushed through each other. Precondition: the
/// boundary does not cut through itself. Cost: some 20 ms for 10 000 triangles a round, mostly of one or two.
void move_nodes(TetMesh& mesh, const Eigen::VectorXd& step, double floor_deg);

}  // namespace palpate::meshing
