// SPDX-License-Identifier: Apache-2.0
#include "runtime/haptics/passivity_observer.hpp"

#include <algorithm>

#include "formats/model/arrays.hpp"
#include "formats/model/geometry/rotations.hpp"

namespace palpate::haptics {

using Eigen::Vector3d;

namespace {

// Lowers a force or torque along the way or turn on which it would give as much again; returns what it gives
// less, at most `most`, N mm.
double take_back(Vector3d& load, const Vector3d& along, double most) noexcept {
    const double gives = load.dot(along);  // if the hand goes on so
    if (!(gives > 0)) return 0;
    const double taken = std::min(gives, most);
    load -= taken / along.squaredNorm() * along;
    return taken;
}

}  // namespace

void PassivityObserver::reset() noexcept {
    for (Tool& tool : tools_) tool = Tool{.feels_torque = tool.feels_torque};
    excess_ = 0;
    watching_ = true;
}

// What a shaft's turning may have stored whose torque nobody feels, N mm.
double PassivityObserver::stored_unfelt(const Tool& tool, const ContactPose& now,
                                        double angle) const noexcept {
    const double turn = are_instruments_ ? angle : (now.shaft - tool.shaft).norm();
    return tool.pressed * length_ * turn;
}

// The work that the tool's forces did on its hand since the last tick above what sampling explains, N mm.
double PassivityObserver::excess_of(Tool& tool, const ContactPose& now,
                                    const VirtualCoupling& coupling) noexcept {
    const Vector3d way = now.tip - tool.tip;
    const Eigen::Quaterniond orientation = orientation_of(now);
    const Vector3d turn = rotation_between(tool.orientation, orientation);
    double excess = tool.force.dot(way) - coupling.stiffness * way.norm() * (way.norm() / 2 + resolution);
    if (tool.feels_torque)
        excess += tool.torque.dot(turn) -
                  coupling.torsional_stiffness * turn.norm() * (turn.norm() / 2 + resolution / length_);
    else
        excess -= stored_unfelt(tool, now, turn.norm());
    if (!way.isZero(0)) tool.way = way;
    if (!turn.isZero(0)) tool.turn = turn;
    tool.tip = now.tip;
    tool.shaft = now.shaft;
    tool.orientation = orientation;
    return excess;
}

void PassivityObserver::damp(std::span<const ContactPose> poses, const VirtualCoupling& coupling,
                             std::span<TickResult> results, std::span<Vector3d> forces) noexcept {
    for (std::size_t t = 0; t < tools_.size(); ++t)
        if (poses[t].trusted) excess_ += excess_of(tools_[t], poses[t], coupling);
    double left = watching_ ? excess_ : 0;  // N mm to take back
    for (std::size_t t = 0; t < tools_.size() && left > 0; ++t) {
        Vector3d torque = vector_of(results[t].torque);
        double taken = take_back(forces[t], tools_[t].way, left);
        if (tools_[t].feels_torque) taken += take_back(torque, tools_[t].turn, left - taken);
        if (!(taken > 0)) continue;
        results[t].torque = array_of(torque);
        results[t].status |= energy_injected;
        left -= taken;
    }
}

void PassivityObserver::hold(std::span<const TickResult> results) noexcept {
    bool touching = false;
    for (std::size_t t = 0; t < tools_.size(); ++t) {
        const TickResult& result = results[t];
        tools_[t].force = vector_of(result.force);
        tools_[t].torque = vector_of(result.torque);
        tools_[t].pressed = 0;
        for (const Contact& contact : result.active_contacts())
            tools_[t].pressed += force_on_tool(contact).norm();
        touching = touching || result.contact_count > 0 || !tools_[t].force.isZero(0);
        if (!has_its_force(result)) watching_ = false;
    }
    if (touching) return;
    excess_ = 0;
    watching_ = true;
}

}  // namespace palpate::haptics
