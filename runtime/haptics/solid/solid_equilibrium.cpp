// SPDX-License-Identifier: Apache-2.0
#include "runtime/haptics/solid/solid_equilibrium.hpp"

#include <algorithm>
#include <cmath>

#include "runtime/haptics/solid/least_distance.hpp"

namespace palpate::haptics {
namespace {

constexpr int most_solid_rounds = 24;
// mm: what a step leaves goes with its square, so after one as short nothing is left.
constexpr double last_step = 2e-4;
// Where steps lead to and fro, as over a corner whose other side is another feature's, they are damped to end
// between.
constexpr int undamped_rounds = 4;
constexpr double damped_by = 0.3;

// How much of a motion is short enough: no point leaves what was looked at, nor, as the tool turns, the
// straight way of safe_part() by more than a quarter of the least gap.
double short_part(const SolidWatch& watch, const Twist& motion) noexcept {
    const double reach = watch.reach_of(motion), turn = motion.tail<3>().norm();
    const double longest_turn = std::sqrt(2 * SolidWatch::least_gap / watch.longest_arm());
    double part = 1;
    if (reach > SolidWatch::longest_step()) part = SolidWatch::longest_step() / reach;
    if (part * turn > longest_turn) part = longest_turn / turn;
    return part;
}

// Whether a motion takes back part of another.
bool leads_back(const Twist& first, const Twist& second, double arm) noexcept {
    return first.head<3>().dot(second.head<3>()) + arm * arm * first.tail<3>().dot(second.tail<3>()) < 0;
}

}  // namespace

ToolRest bring_to_rest(SolidWatch& watch, const TurningCoupling& coupling, ToolPose& pose) noexcept {
    watch.look(pose);
    double left = 0, left_before = 0, damping = 1;
    Twist before = Twist::Zero();
    bool shortened = false;
    for (int round = 0; round < most_solid_rounds; ++round) {
        const NearestMotion nearest = nearest_motion(coupling, pose, watch.touches());
        Twist step = nearest.motion;
        left = watch.reach_of(step);
        if (left <= settled_step) return nearest.keeps_all ? ToolRest::settled : ToolRest::unsettled;
        const bool stalls =
            left > 0.5 * left_before && (!shortened || leads_back(before, step, watch.longest_arm()));
        if (round >= undamped_rounds && stalls) damping *= damped_by;
        left_before = left;
        before = step;
        step *= damping;
        double part = short_part(watch, step);
        part *= watch.safe_part(part * step);
        shortened = part < 1;
        pose = moved(pose, part * step);
        watch.look(pose);
        if (!shortened && damping * left <= last_step) break;
    }
    const NearestMotion rest = nearest_motion(coupling, pose, watch.touches());  // what presses there
    if (!rest.keeps_all || watch.overflowed()) return ToolRest::unsettled;
    if (shortened) return ToolRest::on_its_way;
    return watch.reach_of(rest.motion) <= tolerated_step ? ToolRest::settled : ToolRest::unsettled;
}

}  // namespace palpate::haptics
