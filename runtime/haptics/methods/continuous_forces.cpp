// SPDX-License-Identifier: Apache-2.0
// What the continuous contact's points are and what they do to the tool; part of its tick.
#include <algorithm>

#include "runtime/haptics/methods/continuous_contact.hpp"

namespace palpate::haptics {
namespace {

using Eigen::Vector3d;

constexpr double room_for_rounding = 1e-3;  // mm
constexpr double room_to_follow = 0.1;      // mm that a tool that turns is behind where it would come to rest
constexpr double slightly_beyond = 2e-3;    // mm: of a plane that a tool that turns passes by

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

// Soft bodies push the tool away from where the rigid ones were asked, and so does what turns it: adds the
// contacts that it would meet on the way. Tells whether there are any.
bool ContinuousContact::hold_off_rigid(std::span<TickResult> results) noexcept {
    bool met = false;
    for (std::size_t t = 0; t < tools_.size(); ++t) {
        TickResult& result = results[t];
        if (!equilibrium_.touches_tissue(t) && !is_held(tools_[t])) continue;
        const Vector3d pushed = (equilibrium_.press(t) + equilibrium_.drag(t)) / coupling_;
        for (std::size_t p = 0; p < tools_[t].parts_felt; ++p) {
            Part& part = tools_[t].parts[p];
            const Vector3d push = pushed + equilibrium_.turned_off(t, p);
            const auto touch = part.on_rigid.touch_on_the_way(rigid_surfaces_, part.device + push);
            if (!touch) continue;
            const double gap = touch->normal.dot(touch->foot.point - part.device) + part.on_rigid.radius();
            // Turning bends planes; where one is passed by so little, the next tick finds it.
            if (torsion_ > 0 && gap - touch->normal.dot(push) < slightly_beyond) continue;
            const auto at = static_cast<std::size_t>(result.contact_count);
            if (at == max_contacts) {
                result.status |= contacts_cut;
                continue;
            }
            Contact& contact = result.contacts[at];
            contact = rigid_contact(*touch, touch->normal, gap);
            contact.part = static_cast<std::int32_t>(p);
            if (!equilibrium_.add_wall(t, contact)) {
                result.status |= contacts_cut;
                continue;
            }
            ++result.contact_count;
            met = true;
        }
    }
    return met;
}

// The rigid bodies' hold on a tool that is held by more.
void ContinuousContact::add_rigid_contacts(std::size_t t, TickResult& result) noexcept {
    Tool& tool = tools_[t];
    for (std::size_t p = 0; p < tool.parts_felt; ++p) {
        Part& part = tool.parts[p];
        const auto first = static_cast<std::size_t>(result.contact_count);
        const Vector3d lifted = part.on_rigid.position() + part.on_rigid.held_back() - part.device;
        std::size_t count = 0;
        for (const GodObject::Touch& touch : part.on_rigid.touches()) {
            if (first + count == max_contacts) {
                result.status |= contacts_cut;
                break;
            }
            Contact& contact = result.contacts[first + count];
            contact = rigid_contact(touch, touch.normal, touch.normal.dot(lifted));
            contact.part = static_cast<std::int32_t>(p);
            if (equilibrium_.add_wall(t, contact))
                ++count;
            else
                result.status |= contacts_cut;
        }
        result.contact_count += static_cast<std::int32_t>(count);
        part.rigid_contacts = std::span(result.contacts).subspan(first, count);
    }
}

// What is in equilibrium is no farther from the device than a tool would be if nothing gave way, for there
// its energy is higher; and what friction holds is no farther than it was. In a narrow wedge, where the
// planes of contact push far beyond the surfaces that they stand for, a solution may be. Other tools may push
// tissue against this one: their energy counts too.
bool ContinuousContact::within_reach(std::size_t t, const Vector3d& force) const noexcept {
    double reach = 0, held = 0;
    for (std::size_t other = 0; other < tools_.size(); ++other) {
        if (other != t && !equilibrium_.touches_tissue(other)) continue;
        const Tool& tool = tools_[other];
        for (const Part& part : std::span(tool.parts).first(tool.parts_felt))
            reach += (part.on_all.position() - part.device).norm();
        held = std::max(held, equilibrium_.held_reach(other));
    }
    if (friction_.any()) reach = std::max(reach, held);
    const double room = torsion_ > 0 ? room_to_follow : room_for_rounding;
    return force.norm() <= coupling_ * (reach + room);
}

// Friction of the walls that hold a part besides tissue, N.
Vector3d ContinuousContact::friction_of(const Part& part) const noexcept {
    double press = 0;
    for (const Contact& contact : part.rigid_contacts) press += static_cast<double>(contact.force);
    if (!(press > 0)) return Vector3d::Zero();
    Vector3d drag = -coupling_ * part.on_rigid.held_back();
    const double most = friction_.at_rest * press, wanted = drag.norm();
    if (wanted > most) drag *= most / wanted;
    return drag;
}

// The same of all parts of a tool on which `force` (N) acts besides, but for what would drag it into a wall
// that it does not touch yet.
Vector3d ContinuousContact::wall_friction(std::size_t t, const Vector3d& force) noexcept {
    Tool& tool = tools_[t];
    constexpr int most_walls = 4;
    const auto parts = std::span(tool.parts).first(tool.parts_felt);
    Vector3d drag = Vector3d::Zero();
    for (const Part& part : parts) drag += friction_of(part);
    if (drag == Vector3d::Zero()) return drag;
    for (int wall = 0;; ++wall) {
        std::optional<GodObject::Touch> touch;
        for (std::size_t p = 0; p < parts.size() && !touch; ++p) {
            const Vector3d turned = equilibrium_.turned_off(t, p);
            touch = parts[p].on_rigid.touch_on_the_way(rigid_surfaces_,
                                                       parts[p].device + (force + drag) / coupling_ + turned);
        }
        if (!touch) break;
        const double inwards = touch->normal.dot(drag);
        if (wall == most_walls || !(inwards < 0)) return Vector3d::Zero();
        drag -= inwards * touch->normal;
    }
    double press = 0;
    for (const Part& part : parts)
        for (const Contact& contact : part.rigid_contacts) press += static_cast<double>(contact.force);
    for (const Part& part : parts)
        for (Contact& contact : part.rigid_contacts)
            Eigen::Map<Eigen::Vector3f>(contact.friction.data()) =
                (static_cast<double>(contact.force) / press * drag).cast<float>();
    return drag;
}

}  // namespace palpate::haptics
