// SPDX-License-Identifier: Apache-2.0
#include "runtime/haptics/shell/shell_watch.hpp"

#include <algorithm>
#include <limits>
#include <numbers>

namespace palpate::haptics {

using Eigen::Vector3d;

namespace {

constexpr double slack = 1;  // mm: no motion of less takes a point that is not near close to a body

}  // namespace

void ShellWatch::reset() noexcept {
    moved_ = turned_ = 0;
    gathered_ = false;
    for (Watched& watched : watched_) watched.wake = 0;
    found_count_ = 0;
}

void ShellWatch::look(const ToolPose& pose) noexcept {
    if (gathered_) {
        moved_ += (pose.position - pose_.position).norm();
        turned_ += rotation_between(pose_.orientation, pose.orientation).norm();
    }
    pose_ = pose;
    const double since = moved_ - moved_gathered_ + (turned_ - turned_gathered_) * longest_arm_;
    if (!gathered_ || since > slack) gather();
    found_count_ = 0;
    const Eigen::Matrix3d R_PT = pose.orientation.toRotationMatrix();
    for (const std::int32_t point : std::span(near_).first(near_count_)) {
        const Watched& watched = watched_[static_cast<std::size_t>(point)];
        if (watched.wake <= odometer(watched)) look_at(point, pose, R_PT);
    }
}

bool ShellWatch::touches() const noexcept {
    return std::ranges::any_of(close(), [](const ToolTouch& found) { return found.distance < 0; });
}

void ShellWatch::press(double stiffness) noexcept {
    for (ToolTouch& touch : std::span(found_).first(found_count_))
        touch.press = touch.distance < 0 ? -stiffness * touch.distance * touch.gradient().norm() : 0;
}

void ShellWatch::gather() noexcept {
    near_count_ = 0;
    moved_gathered_ = moved_;
    turned_gathered_ = turned_;
    gathered_ = true;
    for (std::size_t i = 0; i < watched_.size(); ++i)
        if (watched_[i].wake <= odometer(watched_[i]) + slack)
            near_[near_count_++] = static_cast<std::int32_t>(i);
}

// How far a point may go before it can be close to a body, mm. The interpolant is off by at most the field's
// error, and it is no steeper than sqrt(3): along each axis it changes by at most the way, as its samples do.
double ShellWatch::way_until_close(const collision::DistanceField& field, const Vector3d& p,
                                   double interpolant) const noexcept {
    if (!(interpolant < field.band())) return std::max(0.0, field.clearance(p) - field.error() - close_);
    return std::max((interpolant - close_) / std::numbers::sqrt3, interpolant - 2 * field.error() - close_);
}

void ShellWatch::look_at(std::int32_t point, const ToolPose& pose, const Eigen::Matrix3d& R_PT) noexcept {
    const auto at = static_cast<std::size_t>(point);
    const Vector3d arm = R_PT * points_[at].position.cast<double>();
    const Vector3d p = pose.position + arm;
    double clear = std::numeric_limits<double>::infinity();
    for (std::size_t body = 0; body < fields_.size(); ++body) {
        const collision::DistanceField& field = fields_[body];
        const collision::FieldSample sample = field.at(p);
        if (sample.distance < close_) {
            ToolTouch& touch = found_[found_count_++];
            touch.point = point;
            touch.body = static_cast<std::int32_t>(body);
            touch.distance = sample.distance;
            touch.slope << sample.gradient, arm.cross(sample.gradient);
            touch.arm = arm;
            clear = 0;
        } else {
            clear = std::min(clear, way_until_close(field, p, sample.distance));
        }
    }
    Watched& watched = watched_[at];
    watched.wake = odometer(watched) + clear;
}

}  // namespace palpate::haptics
