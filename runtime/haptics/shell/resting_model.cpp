// SPDX-License-Identifier: Apache-2.0
#include "runtime/haptics/shell/resting_model.hpp"

#include <Eigen/Cholesky>
#include <cmath>

namespace palpate::haptics {
namespace {

constexpr int most_turns = 20;
constexpr int most_cuts = 40;  // of a way

}  // namespace

RestingModel::RestingModel(const TurningCoupling& coupling, const ToolPose& pose, double contact_stiffness,
                           std::span<const ToolTouch> touches, double longest_arm) noexcept
    : contact_stiffness_(contact_stiffness), longest_arm_(longest_arm), touches_(touches) {
    spring_.head<3>().setConstant(coupling.stiffness);
    spring_.tail<3>().setConstant(coupling.torsional_stiffness);
    pulled_.head<3>() = pose.position - coupling.device.position;
    pulled_.tail<3>() = rotation_between(coupling.device.orientation, pose.orientation);
}

// The least of the piece that a motion lies in: with those points as springs that are inside there.
Twist RestingModel::least_of_piece(const Twist& motion) const noexcept {
    Eigen::Matrix<double, 6, 6> H = spring_.asDiagonal();
    Twist gradient = spring_.cwiseProduct(pulled_);
    for (const ToolTouch& touch : touches_) {
        const Twist& slope = touch.slope;
        if (touch.distance + slope.dot(motion) >= 0) continue;
        gradient += contact_stiffness_ * touch.distance * slope;
        H.selfadjointView<Eigen::Lower>().rankUpdate(slope, contact_stiffness_);
    }
    return -H.selfadjointView<Eigen::Lower>().ldlt().solve(gradient);
}

// How much of a way from `motion` is downhill, up to all of it: where the energy's derivative along it, which
// rises and is linear by pieces, is zero.
double RestingModel::part_downhill(const Twist& motion, const Twist& way) const noexcept {
    const double pulled = spring_.cwiseProduct(pulled_ + motion).dot(way),
                 bent = spring_.cwiseProduct(way).dot(way);
    double low = 0, high = 1, part = 1;
    for (int cut = 0; cut < most_cuts; ++cut) {
        double slope = pulled + part * bent, curvature = bent;
        for (const ToolTouch& touch : touches_) {
            const double rate = touch.slope.dot(way);
            const double distance = touch.distance + touch.slope.dot(motion) + part * rate;
            if (distance >= 0) continue;
            slope += contact_stiffness_ * distance * rate;
            curvature += contact_stiffness_ * rate * rate;
        }
        if (slope <= 0) {
            if (part >= 1) return 1;
            low = part;
        } else {
            high = part;
        }
        const double next = part - slope / curvature;
        if (std::abs(next - part) <= 1e-12) return part;
        part = next > low && next < high ? next : 0.5 * (low + high);
    }
    return low;
}

Twist RestingModel::least() const noexcept {
    Twist motion = Twist::Zero();
    for (int turn = 0; turn < most_turns; ++turn) {
        Twist way = least_of_piece(motion) - motion;
        way *= part_downhill(motion, way);
        motion += way;
        if (reach_of(way, longest_arm_) <= settled_step) break;
    }
    return motion;
}

}  // namespace palpate::haptics
