// SPDX-License-Identifier: Apache-2.0
// Large deformation, the tick's side: nothing here allocates, locks, waits or throws.
#include "runtime/haptics/contact/large/large_deformation.hpp"

#include <algorithm>

namespace palpate::haptics {

void LargeDeformation::take(ContactEquilibrium& equilibrium, std::span<TickResult> results) noexcept {
    if (!shapes_.refresh()) return;
    const Shapes& shapes = shapes_.front();
    for (std::size_t k = 0; k < softs_.size(); ++k) equilibrium.take_shape(softs_[k], &shapes.of_body[k]);
    for (TickResult& result : results) result.detected_tick = shapes.tick;
    taken_ = shapes.tick;
}

void LargeDeformation::tell(const ContactEquilibrium& equilibrium, std::span<TickResult> results) noexcept {
    const std::int64_t tick = results[0].tick;
    Loads& now = loads_.back();
    now.tick = tick;
    now.taken = taken_;
    bool pressed = false;
    for (std::size_t k = 0; k < softs_.size(); ++k) {
        now.of_body[k].clear();
        equilibrium.each_force(softs_[k], [&](std::int32_t vertex, const Eigen::Vector3d& force) {
            now.of_body[k].push_back({vertex, force.cast<float>()});
        });
        pressed = pressed || !now.of_body[k].empty();
    }
    if (!past_.empty()) copy(now, past_[static_cast<std::size_t>(tick) % remembered]);
    loads_.publish();

    if (!pressed) free_until_ = tick;
    for (TickResult& result : results)
        if (presses_unsettled(result)) result.status |= large_unsettled;
}

bool LargeDeformation::presses_unsettled(const TickResult& result) const noexcept {
    const bool answers_late = result.tick - std::max(taken_, free_until_) > late;
    const auto rigid = static_cast<std::int32_t>(bodies_.rigid_count());
    for (std::size_t k = 0; k < softs_.size(); ++k) {
        if (!answers_late && (taken_ < 0 || shapes_.front().of_body[k].settled)) continue;
        for (const Contact& contact : result.active_contacts())
            if (contact.body == rigid + static_cast<std::int32_t>(softs_[k])) return true;
    }
    return false;
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
