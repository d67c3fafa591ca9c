// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/fem/sound_tetrahedra.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>

#include "formats/model/errors.hpp"

namespace palpate {
namespace {

const Eigen::Vector3d& corner(const TetMesh& mesh, std::size_t t, std::size_t c) {
    return mesh.rest_positions[static_cast<std::size_t>(mesh.tetrahedra[t][c])];
}

double longest_edge(const TetMesh& mesh, std::size_t t) {
    double squared = 0;
    for (std::size_t a = 0; a < 4; ++a)
        for (std::size_t b = a + 1; b < 4; ++b)
            squared = std::max(squared, (corner(mesh, t, a) - corner(mesh, t, b)).squaredNorm());
    return std::sqrt(squared);
}

std::string digits(double value) {
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%.4g", value);
    return text.data();
}

[[noreturn]] void refuse(const TetMesh& mesh, std::size_t t) {
    std::string nodes;
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    for (std::size_t c = 0; c < 4; ++c) {
        nodes += (c == 0 ? "" : ", ") + std::to_string(mesh.tetrahedra[t][c]);
        centre += corner(mesh, t, c) / 4;
    }
    const double quality = element_quality(mesh, t);
    const std::string fault = quality <= -smallest_element_quality ? "is inside out"
                              : std::isfinite(quality)             ? "is flat"
                                                       : "has corners that are not numbers or coincide";
    throw InvalidInput(
        {"tetrahedron " + std::to_string(t),
         "with nodes " + nodes + " around (" + digits(centre.x()) + ", " + digits(centre.y()) + ", " +
             digits(centre.z()) + ") mm " + fault + ": its volume is " + digits(six_volume(mesh, t) / 6) +
             " mm³ at a longest edge of " + digits(longest_edge(mesh, t)) + " mm, quality " + digits(quality),
         "quality above " + digits(smallest_element_quality) + ", where a regular tetrahedron has 1",
         quality <= -smallest_element_quality
             ? "exchange two of its nodes, or mesh again with 'palpate mesh'"
             : "mesh again with 'palpate mesh', or remove it and close the gap"});
}

}  // namespace

double element_quality(const TetMesh& mesh, std::size_t t) {
    return std::numbers::sqrt2 * six_volume(mesh, t) / std::pow(longest_edge(mesh, t), 3);
}

void require_sound_tetrahedra(const TetMesh& mesh) {
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
        if (!(element_quality(mesh, t) > smallest_element_quality)) refuse(mesh, t);
}

}  // namespace palpate
