// SPDX-License-Identifier: Apache-2.0
#include "runtime/haptics/contact/load_spread.hpp"

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
    add_near(body, blocks);
}

void LoadSpread::add_near(const DeformableBody& body, std::span<const std::int32_t> blocks) {
    const auto count = static_cast<std::int32_t>(body.boundary.surface.vertices.size());
    const auto block_of = [&](std::int32_t vertex) { return blocks[static_cast<std::size_t>(vertex)]; };
    SurfaceWalk walk(body.boundary.surface);
    std::vector<Matrix3f> moved(blocks.size());  // by vertex: S C of vertex a, where it is computed
    std::vector<std::int32_t> computed(blocks.size(), -1);
    first_near_.push_back(0);
    for (std::int32_t a = 0; a < count; ++a) {
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
            near_.push_back(b);
            near_blocks_.push_back(sum);
        }
        first_near_.push_back(near_.size());
    }
}

}  // namespace palpate::haptics
