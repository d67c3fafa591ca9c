// SPDX-License-Identifier: Apache-2.0
#include "runtime/haptics/shell/shell_watch.hpp"

#include <algorithm>

namespace palpate::haptics {

using Eigen::Vector3d;

namespace {

constexpr double odometer_end = 2000;  // mm, beyond which float32 has no thousandths

}  // namespace

double ShellWatch::reach_of(const Twist& motion) const noexcept {
    return motion.head<3>().norm() + longest_arm_ * motion.tail<3>().norm();
}

// Rounded up, so that no point sleeps too long.
float ShellWatch::odometer(const Watched& watched) const noexcept {
    return 1.000001F * (static_cast<float>(moved_) + static_cast<float>(turned_) * watched.arm);
}

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
    if (moved_ + turned_ * longest_arm_ > odometer_end) reset();
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
    return std::ranges::any_of(close(), [](const ShellTouch& found) { return found.distance < 0; });
}

void ShellWatch::gather() noexcept {
    near_count_ = 0;
    moved_gathered_ = moved_;
    turned_gathered_ = turned_;
    gathered_ = true;
    for (std::size_t i = 0; i < watched_.size(); ++i)
        if (watched_[i].wake <= odometer(watched_[i]) + static_cast<float>(slack))
            near_[near_count_++] = static_cast<std::int32_t>(i);
}

void ShellWatch::look_at(std::int32_t point, const ToolPose& pose, const Eigen::Matrix3d& R_PT) noexcept {
    const auto at = static_cast<std::size_t>(point);
    const Vector3d arm = R_PT * points_[at].position.cast<double>();
    const Vector3d p = pose.position + arm;
    double clear = odometer_end;
    for (std::size_t body = 0; body < fields_.size(); ++body) {
        const collision::DistanceField& field = fields_[body];
        const collision::FieldSample sample = field.at(p);
        if (sample.distance < close_) {
            found_[found_count_++] = {point, static_cast<std::int32_t>(body), sample.distance,
                                      sample.gradient, arm};
            clear = 0;
        } else {
            // The interpolant is that close only where the distance is so up to its error.
            const double distance =
                sample.distance < field.band() ? sample.distance - field.error() : field.clearance(p);
            clear = std::min(clear, std::max(0.0, distance - field.error() - close_));
        }
    }
    Watched& watched = watched_[at];
    watched.wake = odometer(watched) + static_cast<float>(clear);
}

}  // namespace palpate::haptics
