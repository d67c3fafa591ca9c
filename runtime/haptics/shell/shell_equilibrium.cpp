// SPDX-License-Identifier: Apache-2.0
#include "runtime/haptics/shell/shell_equilibrium.hpp"

#include <Eigen/Cholesky>
#include <algorithm>

namespace palpate::haptics {
namespace {

using Eigen::Vector3d;
using Hessian = Eigen::Matrix<double, 6, 6>;

constexpr int most_rounds = 16;
constexpr int most_turns = 20;  // of the search in a round's model
constexpr int most_halvings = 8;
constexpr double round_off = 1e-12;  // of an energy

// A tool at a pose with what is close to it.
struct Situation {
    const ShellWatch& watch;
    const TurningCoupling& coupling;
    double contact_stiffness;
    const ToolPose& pose;
};

double energy_of(const Situation& at) noexcept {
    double contact = 0;
    for (const ToolTouch& touch : at.watch.close()) {
        const double depth = std::min(touch.distance, 0.0);
        contact += depth * depth;
    }
    const double turn = rotation_between(at.coupling.device.orientation, at.pose.orientation).squaredNorm();
    return 0.5 * (at.coupling.stiffness * (at.pose.position - at.coupling.device.position).squaredNorm() +
                  at.coupling.torsional_stiffness * turn + at.contact_stiffness * contact);
}

// E after a motion in the model in which distances change in proportion to it: convex, quadratic by pieces.
class Model {
  public:
    explicit Model(const Situation& at) noexcept : at_(at) {
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

    // The least of the piece that a motion lies in: with those points as springs that are inside there.
    Twist least_of_piece(const Twist& motion) const noexcept {
        Hessian H = spring_.asDiagonal();
        Twist gradient = spring_.cwiseProduct(pulled_);
        for (const ToolTouch& touch : at_.watch.close()) {
            const Twist& slope = touch.slope;
            if (touch.distance + slope.dot(motion) >= 0) continue;
            gradient += at_.contact_stiffness * touch.distance * slope;
            H.selfadjointView<Eigen::Lower>().rankUpdate(slope, at_.contact_stiffness);
        }
        return -H.selfadjointView<Eigen::Lower>().ldlt().solve(gradient);
    }

    // The motion of least energy, piece by piece downhill.
    Twist least() const noexcept {
        Twist motion = Twist::Zero();
        double lowest = energy(motion);
        for (int turn = 0; turn < most_turns; ++turn) {
            Twist next = least_of_piece(motion);
            double there = energy(next);
            if (!(there < lowest)) {  // points that were clear are inside there: with them
                next = least_of_piece(next);
                there = energy(next);
            }
            for (int halving = 0; !(there < lowest) && halving < most_halvings; ++halving) {
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
    const Situation& at_;
    Twist spring_, pulled_;
};

}  // namespace

ToolRest bring_to_rest(ShellWatch& watch, const TurningCoupling& coupling, double contact_stiffness,
                       double longest_step, ToolPose& pose) noexcept {
    const Situation situation{watch, coupling, contact_stiffness, pose};
    watch.look(pose);
    double energy = energy_of(situation);
    double left = 0;  // of the last step, before it was shortened
    bool shortened = false;
    for (int round = 0; round < most_rounds; ++round) {
        Twist step = Model(situation).least();
        left = watch.reach_of(step);
        if (left <= settled_step) return ToolRest::settled;
        shortened = left > longest_step;
        if (shortened) step *= longest_step / left;
        const ToolPose from = pose;
        for (int halving = 0;; ++halving) {
            pose = moved(from, step);
            watch.look(pose);
            const double lower = energy_of(situation);
            if (lower <= energy * (1 + round_off)) {
                energy = lower;
                break;
            }
            if (halving == most_halvings) {  // a minimum, at a kink of the field
                pose = from;
                watch.look(pose);
                return ToolRest::settled;
            }
            step *= 0.5;
        }
    }
    if (shortened) return ToolRest::on_its_way;
    return left <= tolerated_step ? ToolRest::settled : ToolRest::unsettled;
}

}  // namespace palpate::haptics
