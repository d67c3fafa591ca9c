// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <span>

#include "formats/model/tet_mesh.hpp"
#include "tools/meshing/quality.hpp"

namespace palpate {

/// Doubles nodes where parts of a body meet in a point or an edge but in no face: such hinges carry no
/// elastic force that a refined mesh would show, and make the boundary non-manifold. Returns the number of
/// new nodes.
std::int64_t split_hinges(TetMesh& mesh);

/// Removes pieces (connected through faces) of less than `min_volume` mm³ and the nodes that only they use.
/// Returns the number of pieces removed.
std::int64_t remove_crumbs(TetMesh& mesh, double min_volume);

/// Moves the nodes on region interfaces and on the boundary along their normals so that every region gets its
/// target volume: triangles whose corners lie on a curved surface cut volume off, and this gives it back.
///
/// Region k pushes a node by o_k g_k / a, with g_k the gradient of k's volume at the node and a the interface
/// area around it; the offsets o follow from sum_k (sum_nodes g_l . g_k / a) o_k = target_l - volume_l,
/// solved anew until all volumes agree to 1e-4. No node moves further than `max_distance` mm at a step, and
/// no tetrahedron loses more than half its volume. Precondition: a target for each region of the mesh
/// (checked).
void match_volumes(TetMesh& mesh, std::span<const RegionVolume> targets, double max_distance);

}  // namespace palpate
