// SPDX-License-Identifier: Apache-2.0
#include "runtime/haptics/cones/cone_watch.hpp"

#include <algorithm>

#include "runtime/collision/balls/ball_pairs.hpp"
#include "runtime/collision/cones/cone_pairs.hpp"

namespace palpate::haptics {

using collision::ConeNode;
using collision::ConeReach;

void ConeWatch::reset() noexcept {
    around_.valid = closer_.valid = met_ = false;
    travel_ = {};
    gaps_.forget();
}

void ConeWatch::look(const ToolPose& pose) noexcept {
    if (around_.valid) travel_ += motion_between(pose_, pose);
    pose_ = pose;
    const Eigen::Isometry3d X_PT = placement_of(pose);
    met_ = (met_ || gaps_.is_tight()) && meets(pose);
    if (!around_.holds(pose)) gather(X_PT);
    gaps_.begin(pose.position);
    placed_ = -1;
    if (keeps_)
        look_at_kept(X_PT);
    else
        search(X_PT);
}

void ConeWatch::look_at_kept(const Eigen::Isometry3d& X_PT) noexcept {
    if (!closer_.holds(pose_)) refine(X_PT);
    const ConeReach reach = reach_with({});
    for (const std::size_t at : closer_.all()) {
        Kept& pair = around_.items[at];
        if (pair.due <= travel_.of(pair.arm()) &&
            collision::may_be_nearest(*pair.mine, X_PT, *pair.its, reach))
            look_at(X_PT, pair);
    }
}

ConeReach ConeWatch::reach_with(const Motion& slack) const noexcept {
    return ConeReach(gaps_.within(), slack.way, slack.turn);
}

void ConeWatch::gather(const Eigen::Isometry3d& X_PT) noexcept {
    around_.begin(pose_);
    keeps_ = true;
    closer_.valid = false;
    travel_ = {};
    const ConeReach reach = reach_with(around_.slack);
    for (std::size_t body = 0; body < bodies_.size() && keeps_; ++body)
        keeps_ = collision::for_each_pair(
            tool_, bodies_[body],
            [&](const ConeNode& a, const ConeNode& b) {
                return collision::may_be_nearest(a, X_PT, b, reach);
            },
            [&](const ConeNode& mine, const ConeNode& its) {
                if (around_.count == around_.items.size()) return false;
                around_.items[around_.count++] = {&mine, &its, static_cast<std::int32_t>(body), 0};
                return true;
            });
}

void ConeWatch::refine(const Eigen::Isometry3d& X_PT) noexcept {
    closer_.begin(pose_);
    const ConeReach reach = reach_with(closer_.slack);
    for (std::size_t at = 0; at < around_.count; ++at) {
        const Kept& pair = around_.items[at];
        if (pair.due <= travel_.of(pair.arm()) + closer_.slack.of(pair.arm()) &&
            collision::may_be_nearest(*pair.mine, X_PT, *pair.its, reach))
            closer_.items[closer_.count++] = at;
    }
}

void ConeWatch::search(const Eigen::Isometry3d& X_PT) noexcept {
    const ConeReach reach = reach_with({});
    for (std::size_t body = 0; body < bodies_.size(); ++body)
        collision::for_each_pair(
            tool_, bodies_[body],
            [&](const ConeNode& a, const ConeNode& b) {
                return collision::may_be_nearest(a, X_PT, b, reach);
            },
            [&](const ConeNode& mine, const ConeNode& its) {
                Kept pair{&mine, &its, static_cast<std::int32_t>(body), 0};
                look_at(X_PT, pair);
                return true;
            });
}

void ConeWatch::look_at(const Eigen::Isometry3d& X_PT, Kept& pair) noexcept {
    const collision::SurfaceFeatures &mine = tool_.features(),
                                     &its = bodies_[static_cast<std::size_t>(pair.body)].features();
    const auto triangle = static_cast<std::size_t>(pair.mine->triangle),
               other = static_cast<std::size_t>(pair.its->triangle);
    if (placed_ != pair.mine->triangle) corners_ = collision::placed(X_PT, mine.corners(triangle));
    placed_ = pair.mine->triangle;
    const collision::TriangleCorners corners = its.corners(other);
    collision::local_minima({mine, its, triangle, other, X_PT, corners_, corners}, gaps_.within(), found_);
    pair.due = travel_.of(pair.arm()) + found_.least - gaps_.within() - travel_rounding;
    gaps_.saw(found_.least);
    for (const collision::LocalMinimum& minimum : std::span(found_.minima).first(found_.count))
        gaps_.add({pair.mine->triangle, pair.body, minimum.on_a, minimum.on_b, minimum.distance});
}

bool ConeWatch::meets(const ToolPose& pose) const noexcept {
    const Eigen::Isometry3d X_PT = placement_of(pose);
    return std::ranges::any_of(bodies_, [&](const collision::NormalConeTree& body) {
        return collision::surfaces_meet(tool_, X_PT, body);
    });
}

}  // namespace palpate::haptics
