// SPDX-License-Identifier: Apache-2.0
// One tick of the continuous contact: nothing here allocates, locks, waits or throws.
#include <algorithm>

#include "formats/model/arrays.hpp"
#include "runtime/haptics/methods/continuous_contact.hpp"
#include "runtime/haptics/tool_pose.hpp"

namespace palpate::haptics {
namespace {

using Eigen::Vector3d;

constexpr double unsolved = 1e-3;  // mm of residual that is reported
// In which walls are added that only the solution of the others meets.
constexpr int most_rounds = 12, most_rounds_of_several = 8;  // where the tool is of several spheres
// Of a tool of so many spheres or more, how far they are from all bodies is measured: of so many in a tick,
// up to so many mm.
constexpr std::size_t many_parts = 8, measured_at_once = 4;
constexpr double farthest_measured = 20;
// mm that a sphere of a tool that turns by itself looks ahead, from where the tool is towards its device.
constexpr double farthest_aim = 0.2;
constexpr double farthest_return = 5;  // mm: a sphere of a shaft found again farther off starts anew

}  // namespace

void ContinuousContact::tick(std::span<const ContactPose> poses, const VirtualCoupling& coupling,
                             std::span<TickResult> results, std::span<Vector3d> forces) noexcept {
    coupling_ = coupling.stiffness;
    if (torsion_ > 0) torsion_ = 1 / coupling.torsional_stiffness;
    if (large_.any()) large_.take(equilibrium_, results);
    equilibrium_.begin_tick(coupling_, torsion_);
    for (std::size_t t = 0; t < tools_.size(); ++t) place(t, poses[t], results[t]);
    for (std::size_t t = 0; t < tools_.size(); ++t) follow(t, results[t]);
    bool solve = false;
    for (std::size_t t = 0; t < tools_.size(); ++t) {
        if (!is_held(tools_[t]) && !equilibrium_.touches_tissue(t)) continue;
        begin_walls(t, results[t]);
        solve = true;
    }
    if (solve) {
        equilibrium_.solve();
        const int most = goes_along() ? most_rounds : most_rounds_of_several;
        for (int round = 0; find_other_walls(results, round); ++round) {
            if (round == most) {
                say_led_elsewhere(results);
                break;
            }
            hold_by_other_walls(results, round);
            equilibrium_.solve();
        }
    }
    for (std::size_t t = 0; t < tools_.size(); ++t) {
        if (tools_[t].parts_felt == 0) continue;
        forces[t] = force_of(t, results[t]);
        tools_[t].rested_at = tools_[t].tip + forces[t] / coupling_;
        results[t].tool_position = array_of(tools_[t].rested_at);
        if (torsion_ > 0) tell_turn(t, poses[t], results[t]);
        if (torsion_ > 0) settle(t, forces[t], results[t]);
        if (goes_along()) keep_along(t, results[t]);
    }
    write_neighbours(results);
    equilibrium_.end_tick();
    if (large_.any()) large_.tell(equilibrium_, results);
}

// A tool that turns by itself is held by what is around where it is, and not by what is where its device has
// it: its spheres go on from there.
void ContinuousContact::settle(std::size_t t, const Vector3d& force, const TickResult& result) noexcept {
    Tool& tool = tools_[t];
    tool.was_off_device = !force.isZero(0) || !equilibrium_.turn(t).isZero(0);
    for (Part& part : tool.parts) part.wall_press.setZero();
    if (!tool.was_off_device) return;
    for (const Contact& contact : result.active_contacts())
        if (is_wall(contact))
            tool.parts[static_cast<std::size_t>(contact.part)].wall_press +=
                static_cast<double>(contact.force) * normal_of(contact);
    for (std::size_t p = 0; p < tool.parts_felt; ++p) {
        Part& part = tool.parts[p];
        part.on_rigid.settle_at(rigid_surfaces_,
                                part.device + force / coupling_ + equilibrium_.turned_off(t, p));
    }
}

// Where a sphere is about to go: to its device, but no farther than where the tool may soon be; and against
// the wall that pressed it, for a tool that turns over an edge leaves it where its device has it.
Vector3d ContinuousContact::aim_of(const Tool& tool, const Part& part) const noexcept {
    if (!tool.was_off_device) return part.device;
    const Vector3d from = part.on_rigid.position(), way = part.device - from;
    if (!part.wall_press.isZero(0)) return from - farthest_aim * part.wall_press.normalized();
    return way.norm() > farthest_aim ? Vector3d(from + farthest_aim * way.normalized()) : part.device;
}

// How the tool is turned against its device, and the torque that this takes.
void ContinuousContact::tell_turn(std::size_t t, const ContactPose& pose, TickResult& result) const noexcept {
    const Vector3d& turn = equilibrium_.turn(t);
    result.torque = array_of(Vector3d(turn / torsion_));
    result.tool_orientation = array_of(turned(orientation_of(pose), turn));
}

// Of the bodies that press each other, the first tool that pushes tissue tells.
void ContinuousContact::write_neighbours(std::span<TickResult> results) const noexcept {
    for (std::size_t t = 0; t < tools_.size(); ++t)
        if (results[t].contact_count > 0 && equilibrium_.touches_tissue(t))
            return equilibrium_.write_neighbours(results[t]);
}

Vector3d ContinuousContact::force_of(std::size_t t, TickResult& result) noexcept {
    Tool& tool = tools_[t];
    const auto walls = result.contact_count;
    equilibrium_.write_contacts(t, result);
    const bool found = equilibrium_.solved(t);
    const TickStatus unrest = (equilibrium_.touches_tissue(t) || (torsion_ > 0 && is_held(tool))) &&
                                      equilibrium_.change() > ContactEquilibrium::unsettled
                                  ? contact_unsettled
                                  : tick_ok;
    // Of a tool that turns a wall is in its way all the same.
    const bool blocked = torsion_ > 0 && (result.status & contact_unsolved) != 0;
    if (!blocked && result.contact_count == 0 && (found || !equilibrium_.touches_tissue(t))) {
        result.status |= unrest;
        return rigid_force(tool.parts[0].on_rigid, tool.parts[0].device, result);
    }
    const Vector3d press = equilibrium_.press(t);
    if (equilibrium_.was_cut(t)) result.status |= contacts_cut;
    if (!found) result.status |= contact_unsolved;
    if (!blocked && result.contact_count > 0 && equilibrium_.residual() <= unsolved &&
        within_reach(t, press)) {
        result.status |= unrest;
        result.residual = equilibrium_.residual();
        if (result.contact_count > walls) depth_in_tissue(tool, result);
        Vector3d force = press + equilibrium_.drag(t);
        if (friction_.at_rest > 0 && torsion_ == 0) force += wall_friction(t, force, result);
        return force;
    }
    // The contacts contradict each other. A tool that turns stays where it was, outside of all bodies; of
    // another nothing gives way, and the part that is held most decides.
    result.status |= contact_unsolved;
    result.contact_count = 0;
    if (torsion_ > 0 && equilibrium_.stay(t, tool.rested_at)) return coupling_ * equilibrium_.off(t);
    equilibrium_.forget(t);
    const Part& held = *std::ranges::max_element(
        std::span(tool.parts).first(tool.parts_felt), {},
        [](const Part& part) { return (part.on_all.position() - part.device).squaredNorm(); });
    const Vector3d force = rigid_force(held.on_all, held.device, result);
    if (result.contact_count > 0)
        result.contacts[0].part = static_cast<std::int32_t>(&held - tool.parts.data());
    return force;
}

// How deep the device is below the rest surface of the tissue that it touches.
void ContinuousContact::depth_in_tissue(const Tool& tool, TickResult& result) const noexcept {
    for (const Contact& contact : result.active_contacts()) {
        if (contact.body < static_cast<std::int32_t>(bodies_.rigid_count())) continue;
        const Part& part = tool.parts[static_cast<std::size_t>(contact.part)];
        const double depth = (part.on_all.position() - part.device).norm();
        if (result.body >= 0 && depth <= result.depth) continue;
        result.depth = depth;
        result.body = contact.body;
    }
}

void ContinuousContact::place(std::size_t t, const ContactPose& pose, TickResult& result) noexcept {
    Tool& tool = tools_[t];
    tool.held_beside_tip = false;
    if (!pose.trusted) {
        tool.parts_felt = 0;
        if (goes_along()) along_[t].goes_on = false;
        return;
    }
    if (pose.jumped) forget(t);
    // A shaft that is all that is known of a rod does not roll it.
    const bool has_frame = is_instrument_ || torsion_ > 0;
    if (has_frame && pose.orientation.coeffs().isZero(0) && !pose.shaft.isZero(0) && tool.was_off_device)
        tool.orientation = Eigen::Quaterniond::FromTwoVectors(tool.orientation.col(2), pose.shaft) *
                           Eigen::Matrix3d(tool.orientation);
    else if (has_frame)
        tool.orientation = orientation_of(pose).toRotationMatrix();
    // A rod's spheres lie along its shaft, so that no other axis is asked for.
    Eigen::Matrix3d axes = Eigen::Matrix3d::Zero();
    if (is_instrument_)
        axes = tool.orientation;
    else
        axes.col(2) = pose.shaft;
    tool.tip = pose.tip;
    const std::size_t felt = axes.isZero(0) ? 1 : tool.parts.size();
    for (std::size_t p = 0; p < felt; ++p) {
        Part& part = tool.parts[p];
        const Vector3d to = pose.tip + axes * spheres_[p].centre;
        // While the shaft's direction was not known, nobody saw which way its spheres went.
        if (p > 0 && p >= tool.parts_felt && (to - part.device).norm() > farthest_return) {
            part.on_rigid.reset();
            part.on_all.reset();
            tool.waits = tool.waits || is_instrument_;
        }
        part.device = to;
    }
    tool.parts_felt = felt;
    if (!tool.waits) return;
    tool.waits = !is_clear(tool);
    if (tool.waits) {
        tool.parts_felt = 0;
        result.status |= starts_inside;
        result.tool_orientation = array_of(orientation_of(pose));
        return;
    }
    for (Part& part : std::span(tool.parts).first(felt)) {
        part.on_rigid.start_clear_at(part.device);
        part.on_all.start_clear_at(part.device);
    }
}

// Whether all that is felt of a tool is clear of every body where its device has it.
bool ContinuousContact::is_clear(Tool& tool) const noexcept {
    const auto hits = [&](const Part& part) {
        const double reach = part.on_all.radius() + GodObject::skin;
        return std::ranges::any_of(all_surfaces_, [&](const collision::CollisionSurface* surface) {
            return surface->closest_point(part.device, reach) || !surface->is_outside(part.device);
        });
    };
    for (std::size_t k = 0; k < tool.parts_felt; ++k) {
        const std::size_t p = (tool.stuck + k) % tool.parts_felt;
        if (!hits(tool.parts[p])) continue;
        tool.stuck = p;
        return false;
    }
    return true;
}

void ContinuousContact::forget(std::size_t t) noexcept {
    tools_[t].waits = torsion_ > 0;
    tools_[t].was_off_device = false;
    for (Part& part : tools_[t].parts) {
        part.on_rigid.reset();
        part.on_all.reset();
    }
    if (goes_along()) along_[t].goes_on = false;
    equilibrium_.forget(t);
}

// Between tissue and bone a sphere may come to rest on bone alone, where tissue has kept it from the device.
// Of a tool that turns that cannot be told: its spheres rest elsewhere on bone than they would by themselves.
bool ContinuousContact::kept_by_tissue(const Part& part) const noexcept {
    if (torsion_ > 0) return false;
    const auto touches = part.on_all.touches();
    const auto is_soft = [&](const GodObject::Touch& touch) {
        return touch.surface >= bodies_.rigid_count();
    };
    return !touches.empty() && std::ranges::none_of(touches, is_soft) &&
           (part.on_all.position() - part.device).norm() >
               (part.on_rigid.position() - part.device).norm() + unsolved;
}

// Of a few spheres in turn, how far they are from everything: most of a long tool is far from all bodies.
void ContinuousContact::note_clearances(Tool& tool) noexcept {
    if (tool.parts_felt < many_parts) return;
    for (std::size_t k = 0, measured = 0; k < tool.parts_felt && measured < measured_at_once; ++k) {
        tool.measured_last = (tool.measured_last + 1) % tool.parts_felt;
        Part& part = tool.parts[tool.measured_last];
        // Nothing is known of bodies that it was inside of.
        if (part.on_all.is_known_clear() || !part.on_all.touches().empty()) continue;
        ++measured;
        double nearest = farthest_measured;
        for (const collision::CollisionSurface* surface : all_surfaces_)
            if (const auto found = surface->closest_point(part.on_all.position(), nearest))
                nearest = found->distance;
        part.on_all.note_clearance(nearest);
        if (part.on_rigid.position() == part.on_all.position()) part.on_rigid.note_clearance(nearest);
    }
}

// Moves the god-objects of the tool's parts.
void ContinuousContact::follow(std::size_t t, TickResult& result) noexcept {
    Tool& tool = tools_[t];
    placed_.clear();
    // Of a tool that turns by itself all spheres are held together, in the equilibrium.
    const Friction friction = torsion_ > 0 ? Friction{} : friction_;
    for (std::size_t p = 0; p < tool.parts_felt; ++p) {
        Part& part = tool.parts[p];
        if (!part.on_rigid.move(rigid_surfaces_, aim_of(tool, part), friction))
            result.status |= starts_inside;
        // A lone sphere on rigid bodies needs no second one.
        if (!bodies_.deformable.empty() || tool.parts.size() > 1)
            if (!part.on_all.move(all_surfaces_, part.device)) result.status |= starts_inside;
        placed_.push_back({part.device, &part.on_all, kept_by_tissue(part)});
        if (part.on_rigid.touches().empty()) continue;
        tool.held_beside_tip = tool.held_beside_tip || !spheres_[p].centre.isZero(0);
        const double depth = (part.on_rigid.position() - part.device).norm();
        if (depth <= result.depth) continue;
        result.depth = depth;
        result.body = static_cast<std::int32_t>(part.on_rigid.touches().front().surface);
    }
    note_clearances(tool);
    if (tool.parts_felt > 0)
        equilibrium_.pull(t, tool.tip, tool.orientation, {placed_.data(), placed_.size()});
}

}  // namespace palpate::haptics
