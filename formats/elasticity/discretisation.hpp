// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "formats/model/body.hpp"

namespace palpate::elasticity {

/// The corners at the ends of each edge of a tetrahedron, in the order of a 10-node element's middle nodes.
/// It is the order of VTK's quadratic tetrahedron and of CalculiX' C3D10.
inline constexpr std::array<std::array<std::size_t, 2>, 6> tetrahedron_edges{
    {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}}};

/// The nodes that carry displacements, and the elements over them.
struct Discretisation {
    int nodes_per_element = 4;           ///< 4 (linear) or 10 (quadratic)
    std::size_t node_count = 0;          ///< mesh nodes first, with their numbers, then the middles of edges
    std::vector<std::int32_t> elements;  ///< tetrahedron t's corners, then the middles of tetrahedron_edges
    std::vector<std::array<std::int32_t, 2>> edges;  ///< mesh nodes at the ends of middle node i, whose
                                                     ///< number is (number of mesh nodes) + i; ascending;
                                                     ///< empty if linear
    std::vector<std::int32_t> fixed_nodes;           ///< with zero displacement, ascending
};

/// Numbers the nodes of a mesh's elements. Held are the given mesh nodes (ascending) and, with quadratic
/// elements, the middles of edges of the outer boundary whose ends are both held: an edge that runs through
/// the body between two held nodes stays free to bend, and a held patch of the surface is held throughout.
/// Throws InvalidInput for a tetrahedron that require_sound_tetrahedra refuses. Unchecked: node numbers lie
/// within the mesh. Cost: sorts 6 edges and 4 faces a tetrahedron.
Discretisation discretise(const TetMesh& mesh, ElementOrder order, std::span<const std::int32_t> fixed_nodes);

/// The same for a body: its mesh, element order and fixed nodes.
Discretisation discretise(const DeformableBody& body);

/// Returns the edges of the outer boundary's triangles, each once, lower node first, ascending.
std::vector<std::array<std::int32_t, 2>> boundary_edges(const TetMesh& mesh);

/// Returns the nodes of element t.
std::span<const std::int32_t> nodes_of_element(const Discretisation& discretisation, std::size_t t);

/// For each position, the positions that share an element with it, itself among them, ascending: those of
/// position p are neighbours[offsets[p]] ... neighbours[offsets[p + 1] - 1].
struct NodeGraph {
    std::vector<std::int64_t> offsets;
    std::vector<std::int32_t> neighbours;
};

/// Joins nodes that share an element. Nodes with position_of_node < 0 are left out; the other positions must
/// be 0 ... n-1, each once.
NodeGraph node_graph(const Discretisation& discretisation, std::span<const std::int32_t> position_of_node);

}  // namespace palpate::elasticity
