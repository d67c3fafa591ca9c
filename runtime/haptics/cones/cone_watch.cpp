// SPDX-License-Identifier: Apache-2.0
#include "runtime/haptics/cones/cone_watch.hpp"

#include <algorithm>
#include <array>

#include "runtime/collision/cones/cone_pairs.hpp"
#include "runtime/collision/tree_pairs.hpp"

namespace palpate::haptics {

using collision::ConeNode;
using collision::ConeReach;
using Eigen::Vector3d;

namespace {

constexpr double least_step = 0.005;   // mm, that is taken though nobody knows what it meets
constexpr double part_of_least = 0.9;  // of the least distance, that a step may take

Eigen::Isometry3d placed(const ToolPose& pose) noexcept {
    Eigen::Isometry3d X_PT = Eigen::Isometry3d::Identity();
    X_PT.linear() = pose.orientation.toRotationMatrix();
    X_PT.translation() = pose.position;
    return X_PT;
}

collision::TriangleCorners placed(const Eigen::Isometry3d& X_PT,
                                  const collision::TriangleCorners& of) noexcept {
    return {X_PT * of[0], X_PT * of[1], X_PT * of[2]};
}

}  // namespace

void ConeWatch::look(const ToolPose& pose) noexcept {
    pose_ = pose;
    const Eigen::Isometry3d X_PT = placed(pose);
    met_ = (met_ || part_of_least * least_ < least_step) && meets(pose);
    if (!holds(around_)) gather(X_PT);
    touch_count_ = 0;
    least_ = within_;
    placed_ = -1;
    if (keeps_)
        look_at_kept(X_PT);
    else
        search(X_PT);
}

void ConeWatch::look_at_kept(const Eigen::Isometry3d& X_PT) noexcept {
    if (!holds(closer_)) refine(X_PT);
    const ConeReach reach{.within = within_};
    for (const Kept& pair : closer_.all())
        if (collision::may_be_nearest(*pair.mine, X_PT, *pair.its, reach)) look_at(X_PT, pair);
}

bool ConeWatch::holds(const Near& near) const noexcept {
    if (!near.valid) return false;
    const double turned = rotation_between(near.at.orientation, pose_.orientation).norm();
    const double moved = (pose_.position - near.at.position).norm() + turned * tool_.longest_arm();
    return turned <= near.turn && moved <= near.slack;
}

void ConeWatch::gather(const Eigen::Isometry3d& X_PT) noexcept {
    around_.at = pose_;
    around_.valid = keeps_ = true;
    around_.count = 0;
    closer_.valid = false;
    const ConeReach reach{.within = within_, .slack = around_.slack, .turn = around_.turn};
    for (std::size_t body = 0; body < bodies_.size() && keeps_; ++body)
        keeps_ = collision::for_each_pair(
            tool_, bodies_[body],
            [&](const ConeNode& a, const ConeNode& b) {
                return collision::may_be_nearest(a, X_PT, b, reach);
            },
            [&](const ConeNode& mine, const ConeNode& its) {
                if (around_.count == around_.pairs.size()) return false;
                around_.pairs[around_.count++] = {&mine, &its, static_cast<std::int32_t>(body)};
                return true;
            });
}

void ConeWatch::refine(const Eigen::Isometry3d& X_PT) noexcept {
    closer_.at = pose_;
    closer_.valid = true;
    closer_.count = 0;
    const ConeReach reach{.within = within_, .slack = closer_.slack, .turn = closer_.turn};
    for (const Kept& pair : around_.all())
        if (collision::may_be_nearest(*pair.mine, X_PT, *pair.its, reach))
            closer_.pairs[closer_.count++] = pair;
}

void ConeWatch::search(const Eigen::Isometry3d& X_PT) noexcept {
    const ConeReach reach{.within = within_};
    for (std::size_t body = 0; body < bodies_.size(); ++body)
        collision::for_each_pair(
            tool_, bodies_[body],
            [&](const ConeNode& a, const ConeNode& b) {
                return collision::may_be_nearest(a, X_PT, b, reach);
            },
            [&](const ConeNode& mine, const ConeNode& its) {
                look_at(X_PT, {&mine, &its, static_cast<std::int32_t>(body)});
                return true;
            });
}

void ConeWatch::look_at(const Eigen::Isometry3d& X_PT, const Kept& pair) noexcept {
    const collision::SurfaceFeatures &mine = tool_.features(),
                                     &its = bodies_[static_cast<std::size_t>(pair.body)].features();
    const auto triangle = static_cast<std::size_t>(pair.mine->triangle),
               other = static_cast<std::size_t>(pair.its->triangle);
    if (placed_ != pair.mine->triangle) corners_ = placed(X_PT, mine.corners(triangle));
    placed_ = pair.mine->triangle;
    const collision::TriangleCorners corners = its.corners(other);
    collision::local_minima({mine, its, triangle, other, X_PT, corners_, corners}, within_, found_);
    least_ = std::min(least_, found_.least);
    for (const collision::LocalMinimum& minimum : std::span(found_.minima).first(found_.count))
        add(pair, minimum.on_a, minimum.on_b, minimum.distance);
}

void ConeWatch::add(const Kept& pair, const Vector3d& on_tool, const Vector3d& on_body,
                    double distance) noexcept {
    ToolTouch* touch = nullptr;
    if (touch_count_ < touches_.size()) {
        touch = &touches_[touch_count_++];
    } else {
        touch = &*std::ranges::max_element(touches_, {}, &ToolTouch::distance);
        if (touch->distance <= distance - reach_) return;
    }
    const Vector3d normal = (on_tool - on_body) / distance;
    touch->point = pair.mine->triangle;
    touch->body = pair.body;
    touch->press = 0;
    touch->distance = distance - reach_;
    touch->arm = on_tool - pose_.position;
    touch->slope << normal, touch->arm.cross(normal);
}

void ConeWatch::press(double stiffness) noexcept {
    for (ToolTouch& touch : std::span(touches_).first(touch_count_))
        touch.press = std::max(0.0, -stiffness * touch.distance);
}

double ConeWatch::longest_step() const noexcept {
    return std::clamp(part_of_least * least_, least_step, ahead * reach_);
}

bool ConeWatch::meets(const ToolPose& pose) const noexcept {
    const Eigen::Isometry3d X_PT = placed(pose);
    return !std::ranges::all_of(bodies_, [&](const collision::NormalConeTree& body) {
        return collision::for_each_pair(
            tool_, body,
            [&](const ConeNode& a, const ConeNode& b) { return collision::may_be_near(a, X_PT, b, 0); },
            [&](const ConeNode& mine, const ConeNode& its) {
                const auto pair = collision::closest_points_of_triangles(
                    placed(X_PT, tool_.features().corners(static_cast<std::size_t>(mine.triangle))),
                    body.features().corners(static_cast<std::size_t>(its.triangle)));
                return pair.on_a.squared_distance > 0;
            });
    });
}

}  // namespace palpate::haptics
