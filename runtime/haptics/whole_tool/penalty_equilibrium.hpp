// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "runtime/haptics/tool_pose.hpp"
#include "runtime/haptics/whole_tool/tool_rest.hpp"
#include "runtime/haptics/whole_tool/tool_touch.hpp"

namespace palpate::haptics {

/// How much a search for rest may cost in a tick.
struct PenaltyEffort {
    int rounds = 16;
    int halvings = 8;            ///< of a round's step
    int looks = 16;              ///< at poses, after which no round begins: the next tick goes on from there
    bool crosses_kinks = false;  ///< takes the last of them though the energy rises, unless something is met
};
inline constexpr int penalty_turns = 20, penalty_halvings = 8;  // of the search in a round's model
inline constexpr double energy_round_off = 1e-12;               // of an energy

/// A tool at a pose with what is close to it.
template <typename Watch>
struct PenaltySituation {
    const Watch& watch;
    const TurningCoupling& coupling;
    double contact_stiffness;
    const ToolPose& pose;
};

template <typename Watch>
double energy_of(const PenaltySituation<Watch>& at) noexcept {
    if (at.watch.met()) return std::numeric_limits<double>::infinity();
    double contact = 0;
    for (const ToolTouch& touch : at.watch.close()) {
        const double depth = std::min(touch.distance, 0.0);
        contact += depth * depth;
    }
    const double turn = rotation_between(at.coupling.device.orientation, at.pose.orientation).squaredNorm();
    return 0.5 * (at.coupling.stiffness * (at.pose.position - at.coupling.device.position).squaredNorm() +
                  at.coupling.torsional_stiffness * turn + at.contact_stiffness * contact);
}

/// E after a motion in the model in which distances change in proportion to it: convex, quadratic by pieces.
template <typename Watch>
class PenaltyModel {
  public:
    explicit PenaltyModel(const PenaltySituation<Watch>& at) noexcept : at_(at) {
        spring_.head<3>().setConstant(at.coupling.stiffness);
        spring_.tail<3>().setConstant(at.coupling.torsional_stiffness);
        pulled_.head<3>() = at.pose.position - at.coupling.device.position;
        pulled_.tail<3>() = rotation_between(at.coupling.device.orientation, at.pose.orientation);
    }

    double energy(const Twist& motion) const noexcept {
        double contact = 0;
        for (const ToolTouch& touch : at_.watch.close()) {
            const double depth = std::min(touch.distance + touch.slope.dot(motion), 0.0);
            contact += depth * depth;
        }
        return 0.5 * ((pulled_ + motion).cwiseAbs2().dot(spring_) + at_.contact_stiffness * contact);
    }

    /// The least of the piece that a motion lies in: with those points as springs that are inside there.
    Twist least_of_piece(const Twist& motion) const noexcept {
        Eigen::Matrix<double, 6, 6> H = spring_.asDiagonal();
        Twist gradient = spring_.cwiseProduct(pulled_);
        for (const ToolTouch& touch : at_.watch.close()) {
            const Twist& slope = touch.slope;
            if (touch.distance + slope.dot(motion) >= 0) continue;
            gradient += at_.contact_stiffness * touch.distance * slope;
            H.selfadjointView<Eigen::Lower>().rankUpdate(slope, at_.contact_stiffness);
        }
        return -H.selfadjointView<Eigen::Lower>().ldlt().solve(gradient);
    }

    /// The motion of least energy, piece by piece downhill.
    Twist least() const noexcept {
        Twist motion = Twist::Zero();
        double lowest = energy(motion);
        for (int turn = 0; turn < penalty_turns; ++turn) {
            Twist next = least_of_piece(motion);
            double there = energy(next);
            if (!(there < lowest)) {  // points that were clear are inside there: with them
                next = least_of_piece(next);
                there = energy(next);
            }
            for (int halving = 0; !(there < lowest) && halving < penalty_halvings; ++halving) {
                next = 0.5 * (motion + next);
                there = energy(next);
            }
            if (!(there < lowest)) break;
            const double way = at_.watch.reach_of(next - motion);
            motion = next;
            lowest = there;
            if (way <= settled_step) break;
        }
        return motion;
    }

  private:
    const PenaltySituation<Watch>& at_;
    Twist spring_, pulled_;
};

/// Moves a tool without mass from `pose` downhill to where it rests between its device and what pushes it off
/// by penalties, a minimum of
///     E = 1/2 k |x - x_d|^2 + 1/2 kappa |theta|^2 + sum_i 1/2 K d_i^2,
/// x its position, theta the rotation vector from the device's orientation to its own, d_i < 0 the distances
/// of `watch`'s touches; in rounds, each to the least of E where these change in proportion to the motion
/// (Gauss-Newton, those that come in or go out among them), halved until E goes down and nothing is met; with
/// crosses_kinks the last half is taken nevertheless where E jumps. No
/// step takes a point farther than longest_step(), mm, for the pose last looked at. Leaves in `watch` what is
/// close to the pose. Realtime-safe where `watch` is: look(), close(), met() and reach_of() are asked of it.
template <typename Watch, typename LongestStep>
ToolRest rest_of_penalties(Watch& watch, const TurningCoupling& coupling, double contact_stiffness,
                           const LongestStep& longest_step, const PenaltyEffort& effort,
                           ToolPose& pose) noexcept {
    const PenaltySituation<Watch> situation{watch, coupling, contact_stiffness, pose};
    watch.look(pose);
    double energy = energy_of(situation);
    double left = 0;  // of the last step, before it was shortened
    bool shortened = false;
    int looks = 1;
    for (int round = 0; round < effort.rounds && looks < effort.looks; ++round) {
        Twist step = PenaltyModel<Watch>(situation).least();
        left = watch.reach_of(step);
        if (left <= settled_step) return ToolRest::settled;
        const double longest = longest_step();
        shortened = left > longest;
        if (shortened) step *= longest / left;
        const ToolPose from = pose;
        for (int halving = 0;; ++halving) {
            pose = moved(from, step);
            watch.look(pose);
            ++looks;
            const double lower = energy_of(situation);
            if (lower <= energy * (1 + energy_round_off)) {
                energy = lower;
                break;
            }
            if (halving == effort.halvings && effort.crosses_kinks && std::isfinite(lower)) {
                energy = lower;
                break;
            }
            if (halving == effort.halvings) {  // a minimum at a kink, or the way is barred
                pose = from;
                watch.look(pose);
                return std::isfinite(lower) ? ToolRest::settled : ToolRest::unsettled;
            }
            step *= 0.5;
        }
    }
    if (shortened) return ToolRest::on_its_way;
    return left <= tolerated_step ? ToolRest::settled : ToolRest::unsettled;
}

}  // namespace palpate::haptics
