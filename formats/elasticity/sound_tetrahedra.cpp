// SPDX-License-Identifier: Apache-2.0
#include "formats/elasticity/sound_tetrahedra.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <numbers>
#include <sstream>

#include "formats/model/errors.hpp"

namespace palpate::elasticity {
namespace {

const Eigen::Vector3d& corner(const TetMesh& mesh, std::size_t t, std::size_t c) {
    return mesh.rest_positions[mesh.tetrahedra[t][c]];
}

double longest_edge(const TetMesh& mesh, std::size_t t) {
    double squared = 0;
    for (std::size_t a = 0; a < 4; ++a)
        for (std::size_t b = a + 1; b < 4; ++b)
            squared = std::max(squared, (corner(mesh, t, a) - corner(mesh, t, b)).squaredNorm());
    return std::sqrt(squared);
}

InvalidInput refusal(const TetMesh& mesh, std::size_t t) {
    const Tetrahedron& nodes = mesh.tetrahedra[t];
    const double quality = element_quality(mesh, t);
    const bool inside_out = quality <= -smallest_element_quality;
    const Eigen::Vector3d centre =
        (corner(mesh, t, 0) + corner(mesh, t, 1) + corner(mesh, t, 2) + corner(mesh, t, 3)) / 4;
    std::ostringstream found;
    found << "it is " << (inside_out ? "inside out" : "flat") << ": nodes " << nodes[0] << ", " << nodes[1]
          << ", " << nodes[2] << " and " << nodes[3] << " around (" << std::setprecision(4) << centre.x()
          << ", " << centre.y() << ", " << centre.z() << ") mm span " << std::setprecision(3)
          << six_volume(mesh, t) / 6 << " mm³ over a longest edge of " << longest_edge(mesh, t)
          << " mm, quality " << std::setprecision(2) << quality;
    std::ostringstream expected;
    expected << "quality above " << smallest_element_quality << "; a regular tetrahedron has 1";
    return InvalidInput({"tetrahedron " + std::to_string(t), found.str(), expected.str(),
                         inside_out ? "exchange two of its nodes, or mesh again with 'palpate mesh'"
                                    : "merge its nearest nodes, or mesh again with 'palpate mesh'"});
}

}  // namespace

double element_quality(const TetMesh& mesh, std::size_t t) {
    const double longest = longest_edge(mesh, t);
    return std::numbers::sqrt2 * six_volume(mesh, t) / (longest * longest * longest);
}

void require_sound_tetrahedra(const TetMesh& mesh) {
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
        if (!(element_quality(mesh, t) > smallest_element_quality)) throw refusal(mesh, t);
}

}  // namespace palpate::elasticity
