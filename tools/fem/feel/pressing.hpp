// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "formats/model/contact/load_shares.hpp"

namespace palpate::fem {

/// How a sphere is pressed against each vertex of a body's surface: its load is spread as the trainer's
/// contact spreads it, over a disc as wide as that of contact with a mesh of such elements, or wider if the
/// sphere comes to lie on more.
struct Pressing {
    double tool_radius = 0;            ///< mm
    double depth = 0;                  ///< mm; of the press
    SpreadDisc disc;                   ///< that loads are spread over
    std::vector<std::int32_t> blocks;  ///< compliance_blocks()
    LoadShares shares;
    std::vector<Eigen::Vector3d> normals;  ///< of the surface's vertices, unit, out of the body
};

/// Hertz's circle of contact has the radius a = sqrt(r d); the law of local_indentation.cpp holds from a disc
/// of R = 1.533 a on, where its part in the depth is largest. The disc is at most three times as wide as the
/// mesh's: where a is more than 4.9 edges, surfaces come out too soft, by a sixth where R = a.
Pressing pressing_of(const DeformableBody& body, double tool_radius, double depth);

/// True of a vertex that a sphere can be pressed against: it gives way.
bool can_be_pressed(const Pressing& pressing, std::int32_t vertex);

/// By vertex, mm/N: how far the disc about it gives way along the normal under a force spread over it, n' (S
/// C S') n, from the stored compliance; 0 where it cannot be pressed. Reads as many blocks of C for each
/// vertex as its disc has pairs of vertices; the same at any number of threads.
std::vector<double> spread_compliances(const DeformableBody& body, const Pressing& pressing, int threads);

/// The same of some vertices, for the mesh, materials and fixed nodes of `body`, its compliance unread: one
/// sparse factorisation and a solve for each vertex. Throws as factorise().
std::vector<double> solved_compliances(const DeformableBody& body, const Pressing& pressing,
                                       std::span<const std::int32_t> vertices, int threads);

/// The stiffness F / d of the surface, N/mm, with F such that c F + s(F) = d: c being a disc's compliance
/// (spread_compliances()) and s what the sphere sinks in besides, local_indentation() of tissue with this
/// contact modulus (surface_contact_modulus()). `compliance` must be positive.
double pressed_stiffness(const Pressing& pressing, double compliance, double contact_modulus);

}  // namespace palpate::fem
