// SPDX-License-Identifier: Apache-2.0
#include "runtime/haptics/contact/load_spread.hpp"

#include <algorithm>
#include <future>
#include <thread>

#include "formats/model/contact/surface_walk.hpp"

namespace palpate::haptics {
namespace {

using Eigen::Matrix3f;

constexpr double near_in_radii = 2;  // beyond it, spread forces act like point forces

}  // namespace

LoadSpread::LoadSpread(const DeformableBody& body, std::span<const std::int32_t> blocks)
    : disc_(spread_disc(body, blocks)),
      contact_modulus_(surface_contact_modulus(body)),
      shares_(load_shares(body, blocks, disc_.reach)) {
    const auto count = static_cast<std::int32_t>(body.boundary.surface.vertices.size());
    const auto parts = static_cast<std::int32_t>(std::max(1U, std::thread::hardware_concurrency()));
    std::vector<std::future<NearBlocks>> computed;
    for (std::int32_t part = 0; part < parts; ++part)
        computed.push_back(std::async(std::launch::async, [=, this, &body] {
            const auto bound = [&](std::int64_t p) { return static_cast<std::int32_t>(count * p / parts); };
            return near_blocks(body, blocks, bound(part), bound(part + 1));
        }));
    first_near_.push_back(0);
    for (std::future<NearBlocks>& part : computed) {
        const NearBlocks near = part.get();
        for (const std::size_t vertices : near.counts) first_near_.push_back(first_near_.back() + vertices);
        near_.insert(near_.end(), near.vertices.begin(), near.vertices.end());
        near_blocks_.insert(near_blocks_.end(), near.blocks.begin(), near.blocks.end());
    }
}

LoadSpread::NearBlocks LoadSpread::near_blocks(const DeformableBody& body,
                                               std::span<const std::int32_t> blocks, std::int32_t first,
                                               std::int32_t last) const {
    NearBlocks result;
    const auto block_of = [&](std::int32_t vertex) { return blocks[static_cast<std::size_t>(vertex)]; };
    SurfaceWalk walk(body.boundary.surface);
    std::vector<Matrix3f> moved(blocks.size());  // by vertex: S C of vertex a, where it is computed
    std::vector<std::int32_t> computed(blocks.size(), -1);
    for (std::int32_t a = first; a < last; ++a) {
        std::vector<std::int32_t> near = walk.within(a, near_in_radii * disc_.reach);
        std::erase_if(near, [&](std::int32_t b) { return b < a; });
        std::ranges::sort(near);
        for (const std::int32_t b : near) {
            Matrix3f sum = Matrix3f::Zero();
            for (const Share& there : shares(b)) {
                const auto j = static_cast<std::size_t>(there.vertex);
                if (computed[j] != a) {
                    computed[j] = a;
                    moved[j].setZero();
                    for (const Share& here : shares(a))
                        moved[j] += here.weight * compliance_block(body.compliance, block_of(here.vertex),
                                                                   block_of(there.vertex));
                }
                sum += there.weight * moved[j];
            }
            result.vertices.push_back(b);
            result.blocks.push_back(sum);
        }
        result.counts.push_back(near.size());
    }
    return result;
}

}  // namespace palpate::haptics
