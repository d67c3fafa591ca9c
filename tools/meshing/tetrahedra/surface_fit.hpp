// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <span>

#include "formats/model/tet_mesh.hpp"
#include "tools/meshing/labels/smoothed_labels.hpp"

namespace palpate::meshing {

// Both functions take meshes whose regions are numbered 1, 2, ... No node moves further than
// `max_distance` mm at a step, and each step is one of move_nodes(): no tetrahedron gets flatter than
// `floor_deg` unless it was before, and the boundary stays without cuts.

/// Moves the nodes on region interfaces and on the boundary so that the triangles lie about the labels'
/// surface as closely as flat triangles can: nodes that lie on a curved surface leave their triangles all on
/// one side of it. The displacements d at the nodes are the least-squares fit of the gap g n between
/// triangles and surface: integral N_i (g n - sum_j N_j d_j) = 0, with linear N. So volumes and centroids
/// agree too, to first order. Five rounds with the lumped matrix. Cost: O(tetrahedra).
void fit_surface(TetMesh& mesh, const SmoothedLabels& labels, double floor_deg, double max_distance);

/// Moves the nodes on region interfaces and on the boundary along their normals so that region k gets the
/// volume `volumes[k - 1]`, mm³.
///
/// Region k pushes a node by o_k g_k / a, with g_k the gradient of k's volume at the node and a the interface
/// area around it; the offsets o follow from sum_k (sum_nodes g_l . g_k / a) o_k = target_l - volume_l,
/// solved anew until all volumes agree to 1e-4. Precondition: a volume for each region of the mesh (checked,
/// InvalidInput).
void match_volumes(TetMesh& mesh, std::span<const double> volumes, double floor_deg, double max_distance);

}  // namespace palpate::meshing
