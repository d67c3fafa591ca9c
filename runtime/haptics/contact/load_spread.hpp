// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "formats/model/body.hpp"
#include "formats/model/contact/load_shares.hpp"

namespace palpate::haptics {

/// A body's load_shares(), and the compliance of tissue against forces so spread.
class LoadSpread {
  public:
    using Share = LoadShare;

    /// `blocks`: the compliance block of each surface vertex, -1 for one fixed or left out. Reads some
    /// thousands of blocks of C for each vertex, on all processors.
    LoadSpread(const DeformableBody& body, std::span<const std::int32_t> blocks);

    /// Where a force on a vertex goes, and how much of each displacement counts there. Weights sum to
    /// the part of the disc that gives way.
    std::span<const Share> shares(std::int32_t vertex) const noexcept { return shares_.of(vertex); }

    /// How far vertex a gives way per force on vertex b, both spread, if they are near; nothing if they are
    /// so far apart that spreading changes nothing.
    std::optional<Eigen::Matrix3f> near_compliance(std::int32_t a, std::int32_t b) const noexcept {
        const auto [low, high] = std::minmax(a, b);
        const std::int32_t* const first = near_.data() + first_near_[low];
        const std::int32_t* const last = near_.data() + first_near_[low + 1];
        const std::int32_t* const found = std::lower_bound(first, last, high);
        if (found == last || *found != high) return std::nullopt;
        const Eigen::Matrix3f& block = near_blocks_[static_cast<std::size_t>(found - near_.data())];
        return a == low ? block : Eigen::Matrix3f(block.transpose());
    }

    /// R of the density that loads are spread with on the mean, mm; with what linear elements add.
    double radius() const noexcept { return disc_.radius; }
    /// E / (1 - nu²) of the tissue at the surface, N/mm².
    double contact_modulus() const noexcept { return contact_modulus_; }

  private:
    // Of a range of first vertices: how many are near each, these one after the other, and how each gives
    // way.
    struct NearBlocks {
        std::vector<std::size_t> counts;
        std::vector<std::int32_t> vertices;
        std::vector<Eigen::Matrix3f> blocks;
    };
    NearBlocks near_blocks(const DeformableBody& body, std::span<const std::int32_t> blocks,
                           std::int32_t first, std::int32_t last) const;

    SpreadDisc disc_;
    double contact_modulus_ = 0;
    LoadShares shares_;
    // By first vertex: those from it on that are near, ascending, and how it gives way to them.
    std::vector<std::size_t> first_near_;
    std::vector<std::int32_t> near_;
    std::vector<Eigen::Matrix3f> near_blocks_;
};

}  // namespace palpate::haptics
