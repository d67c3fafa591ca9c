// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/fem/assembly/refinement.hpp"

#include <algorithm>

#include "formats/elasticity/discretisation.hpp"

namespace palpate::fem {
namespace {

using Parts = std::array<std::array<std::size_t, 4>, 4>;

// Nodes of a 10-node tetrahedron. The parts at its corners are scaled copies of it.
constexpr Parts corner_parts{{{0, 4, 6, 7}, {4, 1, 5, 8}, {6, 5, 2, 9}, {7, 8, 9, 3}}};

// The octahedron between them, cut around each of its diagonals.
struct Octahedron {
    std::array<std::size_t, 2> diagonal;
    std::array<std::size_t, 4> ring;  // its other corners, counter-clockwise seen from the diagonal's end
};
constexpr std::array<Octahedron, 3> octahedra{
    {{{4, 9}, {5, 6, 7, 8}}, {{5, 7}, {4, 8, 9, 6}}, {{6, 8}, {4, 5, 9, 7}}}};

Parts inner_parts(const Octahedron& octahedron) {
    Parts parts;
    for (std::size_t i = 0; i < 4; ++i)
        parts[i] = {octahedron.diagonal[0], octahedron.diagonal[1], octahedron.ring[i],
                    octahedron.ring[(i + 1) % 4]};
    return parts;
}

std::vector<std::int32_t> refined_outside_labels(const TetMesh& mesh,
                                                 const elasticity::Discretisation& nodes) {
    std::vector<std::int32_t> labels = mesh.outside_labels;
    const auto on_boundary = elasticity::boundary_edges(mesh);
    for (const auto& edge : nodes.edges)
        labels.push_back(std::ranges::binary_search(on_boundary, edge)
                             ? std::min(mesh.outside_labels[edge[0]], mesh.outside_labels[edge[1]])
                             : -1);
    return labels;
}

}  // namespace

TetMesh refine_uniformly(const TetMesh& mesh) {
    const elasticity::Discretisation nodes = elasticity::discretise(mesh, ElementOrder::quadratic, {});
    TetMesh refined;
    refined.region_names = mesh.region_names;
    refined.outside_names = mesh.outside_names;
    if (!mesh.outside_labels.empty()) refined.outside_labels = refined_outside_labels(mesh, nodes);

    refined.rest_positions = mesh.rest_positions;
    for (const auto& [a, b] : nodes.edges)
        refined.rest_positions.push_back((mesh.rest_positions[a] + mesh.rest_positions[b]) / 2);
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
        const auto element = elasticity::nodes_of_element(nodes, t);
        const auto add = [&](const Parts& parts) {
            for (const auto& part : parts) {
                refined.tetrahedra.push_back(
                    {element[part[0]], element[part[1]], element[part[2]], element[part[3]]});
                refined.regions.push_back(mesh.regions[t]);
            }
        };
        const auto squared_length = [&](const Octahedron& octahedron) {
            return (refined.rest_positions[element[octahedron.diagonal[0]]] -
                    refined.rest_positions[element[octahedron.diagonal[1]]])
                .squaredNorm();
        };
        add(corner_parts);
        add(inner_parts(*std::ranges::min_element(octahedra, {}, squared_length)));
    }
    return refined;
}

}  // namespace palpate::fem
