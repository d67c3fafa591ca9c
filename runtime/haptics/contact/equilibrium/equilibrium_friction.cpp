// SPDX-License-Identifier: Apache-2.0
// Friction between tools and tissue; part of the tick.
//
// Where a sphere presses, friction holds it and the tissue together: the drag on the tool is what undoes the
// way that they have gone past each other, along with the coupling and the tissue's own compliance, until
// that is more than Coulomb's law lets it be.
#include <Eigen/Geometry>
#include <algorithm>

#include "runtime/haptics/contact/equilibrium/contact_equilibrium.hpp"

namespace palpate::haptics {

using Eigen::Index;
using Eigen::Vector3d;

// The vertices that bear a sphere, with their shares of the press.
ContactEquilibrium::Bearings ContactEquilibrium::bearings_of(const Group& group,
                                                             double press) const noexcept {
    Bearings bearings;
    for (const Row& row : rows_of(group))
        for (std::size_t i = 0; i < 3 && row.force > 0; ++i) {
            const double share = row.weights[static_cast<Index>(i)] * row.force / press;
            if (!(share > 0)) continue;
            const auto known = std::find_if(bearings.begin(), bearings.end(), [&](const Bearing& bearing) {
                return bearing.slot == row.slots[i];
            });
            if (known != bearings.end())
                known->share += share;
            else
                bearings.push_back({row.slots[i], share});
        }
    return bearings;
}

// How far a sphere has gone past the tissue that bears it and was not held, mm.
Vector3d ContactEquilibrium::slip_of(const Group& group, const Bearings& bearings) const noexcept {
    const Touch& touch = touch_of(group);
    Vector3d slip = touch.slip;
    if (touch.pressed) {
        const Tool& tool = tools_[static_cast<std::size_t>(group.tool)];
        const Part& part = part_of(group);
        slip += part.sphere.device + off_of(tool, part) - touch.rubbed_centre;
        const DeformedPatch& patch = patch_of(group);
        for (const auto& [slot, share] : bearings)
            slip -= share * (patch.displacement(slot) - patch.displacement_before(slot));
    }
    return slip - touch.axis.dot(slip) * touch.axis;
}

// Friction, for what the present forces press with.
void ContactEquilibrium::rub(std::size_t iterate) noexcept {
    for (DeformedPatch& patch : patches_) patch.begin_hold(iterate);
    for (Tool& tool : tools_)
        for (Part& part : tool.parts)
            for (Touch& touch : part.touches) {
                touch.press = 0;
                touch.next_drag[iterate].setZero();
            }
    for (const Group& group : groups_) {
        Touch& touch = touch_of(group);
        DeformedPatch& patch = patch_of(group);
        Vector3d push = Vector3d::Zero();
        for (const Row& row : rows_of(group)) {
            touch.press += row.force;
            push += row.force * row.normal;
        }
        if (!(touch.press > 0) || !(push.norm() > 0)) continue;
        touch.axis = push.normalized();
        Vector3d& drag = touch.next_drag[iterate];
        drag = touch.drag - touch.axis.dot(touch.drag) * touch.axis;
        const Bearings bearings = bearings_of(group, touch.press);
        const Vector3d slip = slip_of(group, bearings);
        if (const double way = slip.norm(); way > 0) {
            const Vector3d along = slip / way;
            double compliance = 1 / coupling_;
            if (turns()) compliance += torsion_ * part_of(group).swung.cross(along).squaredNorm();
            for (const auto& [slot, share] : bearings)
                for (const auto& [loaded, other] : bearings)
                    compliance += share * other * along.dot(patch.response(slot, loaded, along));
            drag -= slip / compliance;
        }
        const double wanted = drag.norm();
        touch.slides = wanted > (touch.slid ? friction_.sliding : friction_.at_rest) * touch.press;
        touch.slid = touch.slid || touch.slides;
        if (touch.slides) drag *= friction_.sliding * touch.press / wanted;
        for (const auto& [slot, share] : bearings) patch.hold(iterate, slot, -share * drag);
    }
    for (DeformedPatch& patch : patches_) patch.end_hold(iterate);
}

// Where tools and tissue hold on to each other in the next tick.
void ContactEquilibrium::keep_hold() noexcept {
    for (Tool& tool : tools_)
        for (Part& part : tool.parts)
            for (Touch& touch : part.touches) {
                if (touch.press > 0) continue;
                touch.pressed = touch.slid = false;
                touch.slip.setZero();
            }
    for (const Group& group : groups_) {
        const Tool& tool = tools_[static_cast<std::size_t>(group.tool)];
        Touch& touch = touch_of(group);
        if (!(touch.press > 0) || !tool.touching) continue;
        touch.slip = touch.slides ? Vector3d::Zero() : slip_of(group, bearings_of(group, touch.press));
        touch.slid = touch.slides;
        touch.pressed = true;
        const Part& part = part_of(group);
        touch.rubbed_centre = part.sphere.device + off_of(tool, part);
    }
}

}  // namespace palpate::haptics
