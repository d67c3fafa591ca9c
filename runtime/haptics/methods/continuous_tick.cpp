// SPDX-License-Identifier: Apache-2.0
// One tick of the continuous contact: nothing here allocates, locks, waits or throws.
#include <algorithm>
#include <cmath>

#include "formats/model/arrays.hpp"
#include "runtime/haptics/methods/continuous_contact.hpp"

namespace palpate::haptics {
namespace {

using namespace collision;
using Eigen::Vector3d;

constexpr double unsolved = 1e-3;      // mm of residual that is reported
constexpr int most_rounds = 4;         // of contacts that only the solution of the others meets
constexpr double beside_surface = 10;  // mm: farther from a body than this, its motion does not matter

}  // namespace

void ContinuousContact::tick(std::span<const ContactPose> poses, double coupling,
                             std::span<TickResult> results, std::span<Vector3d> forces) noexcept {
    coupling_ = coupling;
    solver_.clear();
    for (std::size_t t = 0; t < tools_.size(); ++t) place(tools_[t], poses[t]);
    for (std::size_t t = 0; t < tools_.size(); ++t) follow(t, results[t]);
    if (solver_.size() == 0) solver_.reset();  // no contact leaves nothing to start from
    double residual = solver_.size() > 0 ? solver_.solve(1 / coupling_) : 0;
    for (int round = 0; round < most_rounds && hold_off_rigid(results); ++round)
        residual = solver_.solve(1 / coupling_);
    for (std::size_t t = 0; t < tools_.size(); ++t) {
        Tool& tool = tools_[t];
        TickResult& result = results[t];
        if (tool.parts_felt == 0) continue;
        forces[t] = force_of(tool, residual, result);
        result.tool_position = array_of(tool.parts[0].device + forces[t] / coupling_);
        const auto contacts = result.active_contacts();
        std::ranges::copy(contacts, tool.last_contacts.begin());
        tool.last_count = contacts.size();
    }
}

Vector3d ContinuousContact::force_of(Tool& tool, double residual, TickResult& result) noexcept {
    if (result.contact_count == 0) return rigid_force(tool.parts[0].on_rigid, tool.parts[0].device, result);
    if (residual <= unsolved && within_reach(tool, result)) {
        result.residual = residual;
        return solved_force(tool, result);
    }
    // The contacts contradict each other: nothing gives way, and the part that is held most decides.
    result.status |= contact_unsolved;
    result.contact_count = 0;
    const Part& held = *std::ranges::max_element(
        std::span(tool.parts).first(tool.parts_felt), {},
        [](const Part& part) { return (part.on_all.position() - part.device).squaredNorm(); });
    const Vector3d force = rigid_force(held.on_all, held.device, result);
    if (result.contact_count > 0)
        result.contacts[0].part = static_cast<std::int32_t>(&held - tool.parts.data());
    return force;
}

void ContinuousContact::place(Tool& tool, const ContactPose& pose) noexcept {
    tool.parts_felt = 0;
    if (!pose.trusted) {
        tool.last_count = 0;
        return;
    }
    if (pose.jumped) forget(tool);
    tool.parts_felt = pose.shaft.squaredNorm() > 0 ? tool.parts.size() : 1;
    for (Part& part : tool.parts) {
        part.device = pose.tip + part.behind_tip * pose.shaft;
        part.moved = 0;
    }
}

void ContinuousContact::forget(Tool& tool) noexcept {
    for (Part& part : tool.parts) {
        part.on_rigid.reset();
        part.on_all.reset();
        for (SoftTouch& touch : part.on_soft) {
            touch.god_object.reset();
            touch.grip = 1;
        }
    }
    tool.last_count = 0;
}

// Moves the god-objects of the tool's parts and gathers the contact points that must be solved together.
void ContinuousContact::follow(std::size_t t, TickResult& result) noexcept {
    Tool& tool = tools_[t];
    bool shaft_held = false;
    for (std::size_t p = 0; p < tool.parts_felt; ++p) {
        Part& part = tool.parts[p];
        if (!part.on_rigid.move(rigid_surfaces_, part.device, friction_)) result.status |= starts_inside;
        // A lone sphere on rigid bodies needs no second one.
        if (!bodies_.deformable.empty() || tool.parts.size() > 1)
            part.on_all.move(all_surfaces_, part.device);
        if (part.on_rigid.touches().empty()) continue;
        shaft_held = shaft_held || p > 0;
        const double depth = (part.on_rigid.position() - part.device).norm();
        if (depth <= result.depth) continue;
        result.depth = depth;
        result.body = static_cast<std::int32_t>(part.on_rigid.touches().front().surface);
    }
    for (std::size_t p = 0; p < tool.parts_felt; ++p)
        for (std::size_t soft = 0; soft < bodies_.deformable.size(); ++soft) follow_soft(t, p, soft, result);
    if (shaft_held || result.contact_count > 0) add_rigid_contacts(t, result);
}

// On a surface that other contacts have moved, a god-object moves as if the surface were at rest and the tool
// had moved the other way.
void ContinuousContact::follow_soft(std::size_t t, std::size_t p, std::size_t soft,
                                    TickResult& result) noexcept {
    Part& part = tools_[t].parts[p];
    SoftTouch& touch = part.on_soft[soft];
    touch.contacts = {};
    const DeformableContact& body = bodies_.deformable[soft];
    const CollisionSurface& surface = *bodies_.surfaces[bodies_.rigid_count() + soft];
    const CollisionSurface* const alone = &surface;
    const Vector3d& wanted = part.on_rigid.position();
    const Vector3d moved = moved_by_others(t, p, soft, wanted);
    part.moved += moved.norm();
    const Vector3d goal = wanted - moved;
    const Friction friction{friction_.at_rest * touch.grip, friction_.sliding * touch.grip};
    if (!touch.god_object.move({&alone, 1}, goal, friction)) result.status |= starts_inside;
    if (touch.god_object.touches().empty()) {
        touch.grip = 1;
        return;
    }
    // Tissue that friction holds to the tool moves with it: seen from that tissue, the tool goes straight in.
    const Vector3d& held = touch.god_object.held_back();
    const auto used = static_cast<std::size_t>(result.contact_count);
    const std::size_t room = std::min(max_contacts - used, max_contacts - solver_.size());
    const std::span<Contact> points = std::span(result.contacts).subspan(used, room);
    const std::size_t count =
        body.collect(surface, touch.god_object, goal - held, part.device - held, points, result.status);
    touch.contacts = points.first(count);
    for (Contact& contact : touch.contacts) contact.part = static_cast<std::int32_t>(p);
    result.contact_count += static_cast<std::int32_t>(count);
    solver_.add(touch.contacts, &body, static_cast<std::int32_t>(t));
    const double depth = (touch.god_object.position() - goal).norm();
    if (depth <= result.depth) return;
    result.depth = depth;
    result.body = body.body_index();
}

// How far the contacts of all other parts and tools, as of the last tick, have moved a body's surface beside
// `place`, mm.
Vector3d ContinuousContact::moved_by_others(std::size_t t, std::size_t p, std::size_t soft,
                                            const Vector3d& place) const noexcept {
    Vector3d moved = Vector3d::Zero();
    if (tools_.size() == 1 && tools_[0].parts.size() == 1) return moved;
    const DeformableContact& body = bodies_.deformable[soft];
    std::optional<Contact> point;
    for (std::size_t other = 0; other < tools_.size(); ++other)
        for (const Contact& contact :
             std::span(tools_[other].last_contacts).first(tools_[other].last_count)) {
            const bool own = other == t && contact.part == static_cast<std::int32_t>(p);
            if (own || contact.body != body.body_index() || !(contact.force > 0)) continue;
            if (!point) {
                const auto foot =
                    bodies_.surfaces[bodies_.rigid_count() + soft]->closest_point(place, beside_surface);
                if (!foot) return moved;
                point = body.point_on(*foot);
            }
            moved += body.displacement_at(*point, {&contact, 1});
        }
    return moved;
}

}  // namespace palpate::haptics
