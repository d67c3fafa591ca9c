// SPDX-License-Identifier: Apache-2.0
#include "runtime/collision/surroundings.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::collision {

using Eigen::Vector3d;

namespace {

constexpr float least_reach = 0.01F;  // mm beyond the sphere: with less, the tree is as quick

}  // namespace

void Surroundings::begin(const CollisionSurface& surface, const Vector3d& p, double radius,
                         double margin) noexcept {
    radius_ = radius;
    reach_ = -1;
    count_ = 0;
    walk_ = surface.walk_near(p.cast<float>(), static_cast<float>(radius + margin));
    centre_ = walk_.centre.cast<double>();
}

void Surroundings::go_on(const CollisionSurface& surface, int nodes) noexcept {
    std::array<std::int32_t, 2> leaf;
    while (surface.next_leaf(walk_, nodes, leaf))
        for (std::int32_t slot = leaf[0]; slot < leaf[0] + leaf[1]; ++slot) take(surface.disc(slot), slot);
    if (walk_.pending == 0) finish();
}

void Surroundings::take(const TriangleDisc& disc, std::int32_t slot) noexcept {
    const std::size_t at = count_;
    nx_[at] = disc.normal[0];
    ny_[at] = disc.normal[1];
    nz_[at] = disc.normal[2];
    x_[at] = disc.centre[0] - walk_.centre[0] + disc.lift * disc.normal[0];
    y_[at] = disc.centre[1] - walk_.centre[1] + disc.lift * disc.normal[1];
    z_[at] = disc.centre[2] - walk_.centre[2] + disc.lift * disc.normal[2];
    circle_[at] = disc.radius + float_error;
    slots_[at] = slot;
    // No point of the triangle is nearer to the centre.
    const float height = std::abs(nx_[at] * x_[at] + ny_[at] * y_[at] + nz_[at] * z_[at]);
    const float away = std::sqrt(x_[at] * x_[at] + y_[at] * y_[at] + z_[at] * z_[at]);
    bound_[at] = std::max(height - plane_error * circle_[at], away - circle_[at]) - float_error;
    if (bound_[at] > walk_.reach)
        walk_.passed_over = std::min(walk_.passed_over, bound_[at]);
    else if (++count_ > capacity)
        shrink();
}

// Halves the margin until a quarter of the room is free.
void Surroundings::shrink() noexcept {
    while (count_ > capacity - capacity / 4) {
        walk_.reach = static_cast<float>(radius_) + 0.5F * (walk_.reach - static_cast<float>(radius_));
        if (walk_.reach < static_cast<float>(radius_) + least_reach) {
            walk_.pending = 0;
            walk_.passed_over = -1;
            count_ = 0;
            return;
        }
        std::size_t kept = 0;
        for (std::size_t at = 0; at < count_; ++at) {
            if (bound_[at] > walk_.reach) {
                walk_.passed_over = std::min(walk_.passed_over, bound_[at]);
                continue;
            }
            x_[kept] = x_[at];
            y_[kept] = y_[at];
            z_[kept] = z_[at];
            circle_[kept] = circle_[at];
            nx_[kept] = nx_[at];
            ny_[kept] = ny_[at];
            nz_[kept] = nz_[at];
            bound_[kept] = bound_[at];
            slots_[kept++] = slots_[at];
        }
        count_ = kept;
    }
}

void Surroundings::finish() noexcept {
    reach_ = std::min(static_cast<double>(walk_.passed_over - float_error), 1e6);
    if (reach_ < 0) count_ = 0;
    for (std::size_t at = count_; at % lanes != 0; ++at) {
        x_[at] = y_[at] = z_[at] = nx_[at] = ny_[at] = nz_[at] = 0;
        circle_[at] = -1e6F;
    }
}

}  // namespace palpate::collision
