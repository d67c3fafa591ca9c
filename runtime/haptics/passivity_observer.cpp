// SPDX-License-Identifier: Apache-2.0
#include "runtime/haptics/passivity_observer.hpp"

#include <algorithm>

#include "formats/model/arrays.hpp"

namespace palpate::haptics {

using Eigen::Vector3d;

void PassivityObserver::reset() noexcept {
    std::fill(tools_.begin(), tools_.end(), Tool{});
    excess_ = 0;
    watching_ = true;
}

void PassivityObserver::damp(std::span<const ContactPose> poses, double coupling,
                             std::span<TickResult> results, std::span<Vector3d> forces) noexcept {
    for (std::size_t t = 0; t < tools_.size(); ++t) {
        if (!poses[t].trusted) continue;
        Tool& tool = tools_[t];
        const Vector3d way = poses[t].tip - tool.tip;
        const Eigen::Quaterniond orientation = orientation_of(poses[t]);
        const double turn = are_instruments_ ? orientation.angularDistance(tool.orientation)
                                             : (poses[t].shaft - tool.shaft).norm();
        excess_ += tool.force.dot(way) - coupling * way.norm() * (way.norm() / 2 + resolution) -
                   tool.pressed * length_ * turn;
        if (!way.isZero(0)) tool.way = way;
        tool.tip = poses[t].tip;
        tool.shaft = poses[t].shaft;
        tool.orientation = orientation;
    }
    double left = watching_ ? excess_ : 0;  // N mm to take back
    for (std::size_t t = 0; t < tools_.size() && left > 0; ++t) {
        const Vector3d& way = tools_[t].way;
        const double gives = forces[t].dot(way);  // N mm, if the hand goes on so
        if (!(gives > 0)) continue;
        const double taken = std::min(gives, left);
        forces[t] -= taken / way.squaredNorm() * way;
        left -= taken;
        results[t].status |= energy_injected;
    }
}

void PassivityObserver::hold(std::span<const TickResult> results) noexcept {
    bool touching = false;
    for (std::size_t t = 0; t < tools_.size(); ++t) {
        const TickResult& result = results[t];
        tools_[t].force = vector_of(result.force);
        tools_[t].pressed = 0;
        for (const Contact& contact : result.active_contacts())
            tools_[t].pressed += force_on_tool(contact).norm();
        touching = touching || result.contact_count > 0 || !tools_[t].force.isZero(0);
        if (result.faults != no_fault || (result.status & coming_back)) watching_ = false;
    }
    if (touching) return;
    excess_ = 0;
    watching_ = true;
}

}  // namespace palpate::haptics
