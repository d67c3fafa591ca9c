// SPDX-License-Identifier: Apache-2.0
// Part of the tick: nothing here allocates, locks, waits or throws.
#include "runtime/haptics/contact/wall_follower.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::haptics {
namespace {

using namespace collision;
using Eigen::Vector3d;

// mm from the sphere within which what it has met stays a wall. In a hollow it touches several in turn, and
// each alone would let it into the others.
constexpr double beside = 0.2;
// mm from it, within which it touches: a sphere that has slid hovers so much.
constexpr double touched = 0.02;

}  // namespace

void WallFollower::start_at(const GodObject& rest) noexcept {
    sphere_.start_at(rest);
    walls_.clear();
    for (const GodObject::Touch& touch : sphere_.touches()) add(touch);
}

void WallFollower::go(Surfaces surfaces, const Vector3d& to) noexcept {
    sphere_.move(surfaces, to);
    const Vector3d& centre = sphere_.position();
    for (GodObject::Touch& wall : walls_) {
        const TrianglePoint foot =
            closest_point_on_triangle(centre, surfaces[wall.surface]->corners(wall.foot.slot));
        wall.foot.point = foot.point;
        wall.foot.barycentric = foot.barycentric;
        wall.foot.feature = foot.feature;
        wall.foot.distance = std::sqrt(foot.squared_distance);
        if (wall.foot.distance > 0) wall.normal = (centre - foot.point) / wall.foot.distance;
    }
    walls_.erase_if([&](const GodObject::Touch& wall) {
        return !(wall.foot.distance > 0) || wall.foot.distance > sphere_.radius() + beside;
    });
    for (const GodObject::Touch& touch : sphere_.touches()) add(touch);
}

bool WallFollower::touches(const GodObject::Touch& wall) const noexcept {
    return wall.foot.distance < sphere_.radius() + touched;
}

void WallFollower::add(const GodObject::Touch& wall) noexcept {
    const auto is_it = [&](const GodObject::Touch& other) {
        return other.surface == wall.surface && other.foot.slot == wall.foot.slot;
    };
    if (std::ranges::any_of(walls_, is_it)) return;
    if (!walls_.full()) return walls_.push_back(wall);
    GodObject::Touch& farthest = *std::ranges::max_element(
        walls_, {}, [](const GodObject::Touch& other) { return other.foot.distance; });
    if (farthest.foot.distance > wall.foot.distance) farthest = wall;
}

}  // namespace palpate::haptics
