// SPDX-License-Identifier: Apache-2.0
#include "runtime/haptics/shell/shell_equilibrium.hpp"

#include <algorithm>

#include "runtime/haptics/shell/resting_model.hpp"

namespace palpate::haptics {
namespace {

constexpr int most_rounds = 16;
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

}  // namespace

ToolRest bring_to_rest(ShellWatch& watch, const TurningCoupling& coupling, double contact_stiffness,
                       double longest_step, ToolPose& pose) noexcept {
    const Situation situation{watch, coupling, contact_stiffness, pose};
    watch.look(pose);
    double energy = energy_of(situation);
    double left = 0;  // of the last step, before it was shortened
    bool shortened = false;
    for (int round = 0; round < most_rounds; ++round) {
        Twist step =
            RestingModel(coupling, pose, contact_stiffness, watch.close(), watch.longest_arm()).least();
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
