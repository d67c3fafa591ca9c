// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "formats/model/body.hpp"

namespace palpate::haptics {

/// How a force on one vertex of a deformable surface is spread over its neighbours, and the displacements
/// there averaged, so that contact does not feel the mesh; and the compliance of tissue against such forces.
/// The derivation stands in load_spread.cpp.
class LoadSpread {
  public:
    struct Share {
        std::int32_t vertex = 0;
        float weight = 0;
    };

    /// `blocks`: the compliance block of each surface vertex, -1 for one fixed or left out. Reads some ten
    /// thousand blocks of C for each vertex: about a second for 2 000.
    LoadSpread(const DeformableBody& body, std::span<const std::int32_t> blocks);

    /// Where a force on a vertex goes, and how much of each displacement counts there; weights sum to 1, of
    /// which `freedom` is on vertices that give way.
    std::span<const Share> shares(std::int32_t vertex) const noexcept {
        return std::span(shares_).subspan(first_share_[vertex],
                                          first_share_[vertex + 1] - first_share_[vertex]);
    }
    double freedom(std::int32_t vertex) const noexcept { return freedom_[vertex]; }

    /// How far vertex a gives way per force on vertex b, both spread, if they are near; null if they are so
    /// far apart that spreading changes nothing.
    const Eigen::Matrix3f* near_compliance(std::int32_t a, std::int32_t b) const noexcept {
        const std::int32_t* const first = near_.data() + first_near_[a];
        const std::int32_t* const last = near_.data() + first_near_[a + 1];
        const std::int32_t* const found = std::lower_bound(first, last, b);
        return found != last && *found == b ? near_blocks_.data() + (found - near_.data()) : nullptr;
    }

    /// mm: beyond it, a vertex has no share.
    double radius() const noexcept { return radius_; }
    /// E / (1 - nu²) of the tissue at the surface, N/mm².
    double contact_modulus() const noexcept { return contact_modulus_; }

  private:
    double radius_ = 0, contact_modulus_ = 0;
    std::vector<std::size_t> first_share_, first_near_;
    std::vector<Share> shares_;
    std::vector<float> freedom_;
    std::vector<std::int32_t> near_;
    std::vector<Eigen::Matrix3f> near_blocks_;
};

}  // namespace palpate::haptics
