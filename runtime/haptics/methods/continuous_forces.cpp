// SPDX-License-Identifier: Apache-2.0
// What the continuous contact's points are and what they do to the tool; part of its tick.
#include <algorithm>

#include "runtime/haptics/methods/continuous_contact.hpp"

namespace palpate::haptics {
namespace {

using Eigen::Vector3d;

constexpr double room_for_rounding = 1e-3;  // mm
constexpr double room_to_follow = 0.1;      // mm that a tool that turns is behind where it would come to rest

}  // namespace

Contact ContinuousContact::rigid_contact(const GodObject::Touch& touch, const Vector3d& normal,
                                         double gap) const noexcept {
    Contact contact;
    contact.body = static_cast<std::int32_t>(touch.surface);
    contact.triangle = touch.foot.triangle;
    if (touch.surface <
        bodies_.rigid_count()) {  // a soft body that does not give way gets no vertices to move
        contact.vertices = bodies_.triangles[touch.surface][touch.foot.triangle];
        Eigen::Map<Eigen::Vector3f>(contact.weights.data()) = touch.foot.barycentric.cast<float>();
    }
    Eigen::Map<Eigen::Vector3f>(contact.normal.data()) = normal.cast<float>();
    contact.gap = static_cast<float>(gap);
    return contact;
}

// Where only the tip touches, and nothing gives way, the spring to its god-object says it all. Several walls
// that hold it have one record: their resultant, and friction.
Vector3d ContinuousContact::rigid_force(const GodObject& tip, const Vector3d& device,
                                        TickResult& result) const noexcept {
    if (tip.touches().empty()) return Vector3d::Zero();
    const Vector3d force = coupling_ * (tip.position() - device);
    const Vector3d drag = -coupling_ * tip.held_back(), press = force - drag;
    Contact& contact = result.contacts[result.contact_count++];
    contact = rigid_contact(tip.touches().front(), press.normalized(), press.norm() / coupling_);
    contact.force = static_cast<float>(press.norm());
    Eigen::Map<Eigen::Vector3f>(contact.friction.data()) = drag.cast<float>();
    return force;
}

// What is in equilibrium is no farther from the device than a tool would be if nothing gave way, for there
// its energy is higher; what friction holds is no farther than it was, and so is a tool that turns, which may
// be held where its spheres by themselves would not be, as behind a ridge that they slid over. In a narrow
// wedge, where the planes of contact push far beyond the surfaces that they stand for, a solution may be.
// Other tools may push tissue against this one: their energy counts too.
bool ContinuousContact::within_reach(std::size_t t, const Vector3d& force) const noexcept {
    double reach = 0, held = 0;
    for (std::size_t other = 0; other < tools_.size(); ++other) {
        if (other != t && !equilibrium_.touches_tissue(other)) continue;
        const Tool& tool = tools_[other];
        for (const Part& part : std::span(tool.parts).first(tool.parts_felt))
            reach += (part.on_all.position() - part.device).norm();
        held = std::max(held, equilibrium_.held_reach(other));
    }
    if (friction_.any() || torsion_ > 0) reach = std::max(reach, held);
    const double room = torsion_ > 0 ? room_to_follow : room_for_rounding;
    return force.norm() <= coupling_ * (reach + room);
}

// Friction of the walls that hold part `p` of a tool besides tissue, N.
Vector3d ContinuousContact::friction_of(std::size_t t, std::size_t p,
                                        const TickResult& result) const noexcept {
    Vector3d drag = -coupling_ * tools_[t].parts[p].on_rigid.held_back();
    if (drag.isZero(0)) return drag;
    double press = 0;
    for (const Contact& contact : result.active_contacts())
        if (is_wall(contact) && contact.part == static_cast<std::int32_t>(p))
            press += static_cast<double>(contact.force);
    const double most = friction_.at_rest * press, wanted = drag.norm();
    return wanted > most ? most / wanted * drag : drag;
}

// The same of all parts of a tool that does not turn by itself, on which `force` (N) acts besides, but for
// what would drag it into a wall that it does not touch yet.
Vector3d ContinuousContact::wall_friction(std::size_t t, const Vector3d& force, TickResult& result) noexcept {
    Tool& tool = tools_[t];
    constexpr int most_walls = 4;
    const auto parts = std::span(tool.parts).first(tool.parts_felt);
    Vector3d drag = Vector3d::Zero();
    for (std::size_t part = 0; part < parts.size(); ++part) drag += friction_of(t, part, result);
    if (drag == Vector3d::Zero()) return drag;
    for (int wall = 0;; ++wall) {
        std::optional<GodObject::Touch> touch;
        for (std::size_t p = 0; p < parts.size() && !touch; ++p) {
            GodObject& sphere = goes_along() ? along_[t].follower.sphere() : parts[p].on_rigid;
            touch = sphere.touch_on_the_way(rigid_surfaces_, parts[p].device + (force + drag) / coupling_);
        }
        if (!touch) break;
        const double inwards = touch->normal.dot(drag);
        if (wall == most_walls || !(inwards < 0)) return Vector3d::Zero();
        drag -= inwards * touch->normal;
    }
    const auto contacts = std::span(result.contacts).first(static_cast<std::size_t>(result.contact_count));
    double press = 0;
    for (const Contact& contact : contacts)
        if (is_wall(contact)) press += static_cast<double>(contact.force);
    for (Contact& contact : contacts)
        if (is_wall(contact))
            Eigen::Map<Eigen::Vector3f>(contact.friction.data()) =
                (static_cast<double>(contact.force) / press * drag).cast<float>();
    return drag;
}

}  // namespace palpate::haptics
