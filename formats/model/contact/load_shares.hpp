// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "formats/model/body.hpp"

namespace palpate {

/// What a vertex takes of a force on another.
struct LoadShare {
    std::int32_t vertex = 0;
    float weight = 0;
};

/// How a force on one vertex of a deformable surface is spread over its neighbours, and the displacements
/// there averaged, so that contact does not feel the mesh. The derivation stands in load_shares.cpp.
struct LoadShares {
    /// Where a force on a vertex goes, and how much of each displacement counts there. Weights sum to the
    /// part of the disc that gives way.
    std::span<const LoadShare> of(std::int32_t vertex) const noexcept {
        return std::span(shares).subspan(first[vertex], first[vertex + 1] - first[vertex]);
    }

    std::vector<std::size_t> first;
    std::vector<LoadShare> shares;
};

/// How wide the disc is that contact spreads loads over, from the edges of a surface.
struct SpreadDisc {
    double reach = 0;   ///< mm; where the density ends
    double radius = 0;  ///< mm; R of the density, with what linear elements add on the mean
};

/// The disc for a body whose vertices have these blocks of the compliance (compliance_blocks()).
SpreadDisc spread_disc(const DeformableBody& body, std::span<const std::int32_t> blocks);
/// The same disc widened to `reach`, mm, if it was narrower.
SpreadDisc widened(const SpreadDisc& disc, double reach);

/// The shares of every vertex over discs of this reach, mm.
LoadShares load_shares(const DeformableBody& body, std::span<const std::int32_t> blocks, double reach);

/// E / (1 - nu²) of the tetrahedra that have a contact node, N/mm²: the mean of their compliances; 0 if no
/// material is known.
double surface_contact_modulus(const DeformableBody& body);

}  // namespace palpate
