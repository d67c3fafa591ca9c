// SPDX-License-Identifier: Apache-2.0
// Large deformation, the tick's side: nothing here allocates, locks, waits or throws.
#include "runtime/haptics/contact/large/large_deformation.hpp"

namespace palpate::haptics {

void LargeDeformation::take(ContactEquilibrium& equilibrium, std::span<TickResult> results) noexcept {
    if (!shapes_.refresh()) return;
    const Shapes& shapes = shapes_.front();
    for (std::size_t k = 0; k < softs_.size(); ++k) equilibrium.take_shape(softs_[k], &shapes.of_body[k]);
    for (TickResult& result : results) result.detected_tick = shapes.tick;
    taken_ = shapes.tick;
}

void LargeDeformation::tell(const ContactEquilibrium& equilibrium, std::int64_t tick) noexcept {
    Loads& now = loads_.back();
    now.tick = tick;
    now.taken = taken_;
    for (std::size_t k = 0; k < softs_.size(); ++k) {
        now.of_body[k].clear();
        equilibrium.each_force(softs_[k], [&](std::int32_t vertex, const Eigen::Vector3d& force) {
            now.of_body[k].push_back({vertex, force.cast<float>()});
        });
    }
    if (!past_.empty()) copy(now, past_[static_cast<std::size_t>(tick) % remembered]);
    loads_.publish();
}

void LargeDeformation::copy(const Loads& from, Loads& to) noexcept {
    to.tick = from.tick;
    to.taken = from.taken;
    for (std::size_t k = 0; k < from.of_body.size(); ++k) {
        to.of_body[k].clear();
        for (const SurfaceForce& force : from.of_body[k]) to.of_body[k].push_back(force);
    }
}

}  // namespace palpate::haptics
