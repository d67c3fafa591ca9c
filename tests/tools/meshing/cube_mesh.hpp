// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <utility>

#include "formats/model/tet_mesh.hpp"

namespace palpate::test {

/// Adds the unit cube at (i, j, k), cut into six tetrahedra around its diagonal; node(i, j, k) numbers
/// corners.
template <typename Node>
void add_cube(TetMesh& mesh, const std::array<int, 3>& corner, std::int32_t region, const Node& node) {
    const auto& [i, j, k] = corner;
    for (const auto& [a, b] : {std::pair(0, 1), std::pair(1, 2), std::pair(2, 0), std::pair(1, 0),
                               std::pair(2, 1), std::pair(0, 2)}) {
        std::array<int, 3> first = corner, second = corner;
        ++first[static_cast<std::size_t>(a)];
        ++second[static_cast<std::size_t>(a)];
        ++second[static_cast<std::size_t>(b)];
        Tetrahedron tet{node(i, j, k), node(first[0], first[1], first[2]),
                        node(second[0], second[1], second[2]), node(i + 1, j + 1, k + 1)};
        if ((b - a + 3) % 3 == 2) std::swap(tet[1], tet[2]);
        mesh.tetrahedra.push_back(tet);
        mesh.regions.push_back(region);
    }
}

}  // namespace palpate::test
