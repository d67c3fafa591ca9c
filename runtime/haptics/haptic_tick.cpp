// SPDX-License-Identifier: Apache-2.0
// One tick of a haptic model: nothing here allocates, locks, waits or throws.
#include <algorithm>
#include <cassert>
#include <cmath>

#include "formats/model/arrays.hpp"
#include "runtime/haptics/haptic_model.hpp"

namespace palpate {
namespace {

using Eigen::Vector3d;

constexpr double unsolved = 1e-3;      // mm of residual that is reported
constexpr int most_rounds = 4;         // of contacts that only the solution of the others meets
constexpr double farthest_return = 5;  // mm: found again farther off than this, a tool starts anew
constexpr double beside_surface = 10;  // mm: farther from a body than this, its motion does not matter

// What contacts press the tool with, friction left out, N.
Vector3d pressed(const TickResult& result) noexcept {
    Vector3d force = Vector3d::Zero();
    for (const Contact& contact : result.active_contacts())
        force += static_cast<double>(contact.force) * normal_of(contact);
    return force;
}

}  // namespace

void HapticModel::detect() noexcept {
    if (published_) published_->detect();
}

void HapticModel::detect_at(const std::array<double, 3>& device, std::int64_t tick) noexcept {
    if (published_) published_->detect_at(device, tick);
}

void HapticModel::tick(std::span<const DeviceState> devices, std::span<TickResult> results,
                       std::uint32_t faults) noexcept {
    assert(devices.size() == tools_.size() && results.size() == tools_.size());
    solver_.clear();
    for (std::size_t t = 0; t < tools_.size(); ++t) {
        results[t].tool = static_cast<std::int32_t>(t);
        results[t].faults = faults | devices[t].faults;
        begin(tools_[t], devices[t], results[t]);
    }
    ++tick_;
    if (published_) {
        if (tools_[0].parts_felt > 0)
            finish(tools_[0], published_->tick(tools_[0].parts[0].device, coupling_, results[0]), results[0]);
        else
            published_->lose();
        return;
    }
    for (std::size_t t = 0; t < tools_.size(); ++t) follow(t, results[t]);
    if (solver_.size() == 0) solver_.reset();  // no contact leaves nothing to start from
    double residual = solver_.size() > 0 ? solver_.solve(1 / coupling_) : 0;
    for (int round = 0; round < most_rounds && hold_off_rigid(results); ++round)
        residual = solver_.solve(1 / coupling_);
    for (std::size_t t = 0; t < tools_.size(); ++t) {
        Tool& tool = tools_[t];
        TickResult& result = results[t];
        if (tool.parts_felt == 0) continue;
        if (result.contact_count == 0) {
            finish(tool, rigid_force(tool.parts[0].on_rigid, tool.parts[0].device, result), result);
        } else if (residual <= unsolved && within_reach(tool, result)) {
            result.residual = residual;
            finish(tool, solved_force(tool, result), result);
        } else {
            // The contacts contradict each other: nothing gives way, and the part that is held most decides.
            result.status |= contact_unsolved;
            result.contact_count = 0;
            const Part& held = *std::ranges::max_element(
                std::span(tool.parts).first(tool.parts_felt), {},
                [](const Part& part) { return (part.on_all.position() - part.device).squaredNorm(); });
            const Vector3d force = rigid_force(held.on_all, held.device, result);
            if (result.contact_count > 0)
                result.contacts[0].part = static_cast<std::int32_t>(&held - tool.parts.data());
            finish(tool, force, result);
        }
        const auto contacts = result.active_contacts();
        std::ranges::copy(contacts, tool.last_contacts.begin());
        tool.last_count = contacts.size();
    }
}

void HapticModel::begin(Tool& tool, const DeviceState& device, TickResult& result) noexcept {
    result.tick = tick_;
    result.time = device.time;
    result.device_position = result.tool_position = device.position;
    result.shaft = device.shaft;
    result.buttons = device.buttons;
    result.detected_tick = -1;
    result.depth = 0;
    result.residual = 0;
    result.body = -1;
    result.contact_count = 0;
    result.status = tick_ok;
    const Vector3d tip = vector_of(device.position), shaft = vector_of(device.shaft);
    tool.parts_felt = 0;
    if (!tip.allFinite() || !shaft.allFinite()) result.faults |= invalid_position;
    if (result.faults & distrusted_position) {
        result.force = array_of(tool.limiter.limit(Vector3d::Zero(), result.faults, result.status));
        tool.last_count = 0;
        tool.lost = true;
        return;
    }
    // The way there was not seen, so it says nothing about what lies between.
    const bool unseen = tool.lost || (result.faults & tick_late);
    if (unseen && (tip - tool.parts[0].device).norm() > farthest_return) forget(tool);
    tool.lost = false;
    tool.parts_felt = shaft.squaredNorm() > 0 ? tool.parts.size() : 1;
    for (Part& part : tool.parts) {
        part.device = tip + part.behind_tip * shaft;
        part.moved = 0;
    }
}

void HapticModel::forget(Tool& tool) noexcept {
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
void HapticModel::follow(std::size_t t, TickResult& result) noexcept {
    Tool& tool = tools_[t];
    bool shaft_held = false;
    for (std::size_t p = 0; p < tool.parts_felt; ++p) {
        Part& part = tool.parts[p];
        if (!part.on_rigid.move(rigid_surfaces_, part.device, friction_)) result.status |= starts_inside;
        // A lone sphere on rigid bodies needs no second one.
        if (!deformable_.empty() || tool.parts.size() > 1) part.on_all.move(all_surfaces_, part.device);
        if (part.on_rigid.touches().empty()) continue;
        shaft_held = shaft_held || p > 0;
        const double depth = (part.on_rigid.position() - part.device).norm();
        if (depth <= result.depth) continue;
        result.depth = depth;
        result.body = static_cast<std::int32_t>(part.on_rigid.touches().front().surface);
    }
    for (std::size_t p = 0; p < tool.parts_felt; ++p)
        for (std::size_t soft = 0; soft < deformable_.size(); ++soft) follow_soft(t, p, soft, result);
    if (shaft_held || result.contact_count > 0) add_rigid_contacts(t, result);
}

// On a surface that other contacts have moved, a god-object moves as if the surface were at rest and the tool
// had moved the other way.
void HapticModel::follow_soft(std::size_t t, std::size_t p, std::size_t soft, TickResult& result) noexcept {
    Part& part = tools_[t].parts[p];
    SoftTouch& touch = part.on_soft[soft];
    touch.contacts = {};
    const DeformableContact& body = deformable_[soft];
    const CollisionSurface& surface = *surfaces_[rigid_count() + soft];
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
Vector3d HapticModel::moved_by_others(std::size_t t, std::size_t p, std::size_t soft,
                                      const Vector3d& place) const noexcept {
    Vector3d moved = Vector3d::Zero();
    if (tools_.size() == 1 && tools_[0].parts.size() == 1) return moved;
    const DeformableContact& body = deformable_[soft];
    std::optional<Contact> point;
    for (std::size_t other = 0; other < tools_.size(); ++other)
        for (const Contact& contact :
             std::span(tools_[other].last_contacts).first(tools_[other].last_count)) {
            const bool own = other == t && contact.part == static_cast<std::int32_t>(p);
            if (own || contact.body != body.body_index() || !(contact.force > 0)) continue;
            if (!point) {
                const auto foot = surfaces_[rigid_count() + soft]->closest_point(place, beside_surface);
                if (!foot) return moved;
                point = body.point_on(*foot);
            }
            moved += body.displacement_at(*point, {&contact, 1});
        }
    return moved;
}

Contact HapticModel::rigid_contact(const GodObject::Touch& touch, const Vector3d& normal,
                                   double gap) const noexcept {
    Contact contact;
    contact.body = static_cast<std::int32_t>(touch.surface);
    contact.triangle = touch.foot.triangle;
    if (touch.surface < rigid_count()) {  // a soft body that does not give way gets no vertices to move
        contact.vertices = rigid_triangles_[touch.surface][touch.foot.triangle];
        Eigen::Map<Eigen::Vector3f>(contact.weights.data()) = touch.foot.barycentric.cast<float>();
    }
    Eigen::Map<Eigen::Vector3f>(contact.normal.data()) = normal.cast<float>();
    contact.gap = static_cast<float>(gap);
    return contact;
}

// Where only the tip touches, and nothing gives way, the spring to its god-object says it all. Several walls
// that hold it have one record: their resultant, and friction.
Vector3d HapticModel::rigid_force(const GodObject& tip, const Vector3d& device,
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

// Soft bodies push the tool away from where the rigid ones were asked: adds the contacts that it would meet
// on the way. Tells whether there are any.
bool HapticModel::hold_off_rigid(std::span<TickResult> results) noexcept {
    bool met = false;
    for (std::size_t t = 0; t < tools_.size(); ++t) {
        TickResult& result = results[t];
        if (tools_[t].parts_felt == 0 || result.contact_count == 0) continue;
        const Vector3d push = pressed(result) / coupling_;
        for (std::size_t p = 0; p < tools_[t].parts_felt; ++p) {
            Part& part = tools_[t].parts[p];
            const auto touch = part.on_rigid.touch_on_the_way(rigid_surfaces_, part.device + push);
            if (!touch) continue;
            const auto at = static_cast<std::size_t>(result.contact_count);
            if (solver_.size() == max_contacts || at == max_contacts) {
                result.status |= contacts_cut;
                continue;
            }
            const double gap = touch->normal.dot(touch->foot.point - part.device) + part.on_rigid.radius();
            Contact& contact = result.contacts[at];
            contact = rigid_contact(*touch, touch->normal, gap);
            contact.part = static_cast<std::int32_t>(p);
            ++result.contact_count;
            solver_.add({&contact, 1}, nullptr, static_cast<std::int32_t>(t));
            met = true;
        }
    }
    return met;
}

// The rigid bodies' hold on a tool that is held by more.
void HapticModel::add_rigid_contacts(std::size_t t, TickResult& result) noexcept {
    Tool& tool = tools_[t];
    for (std::size_t p = 0; p < tool.parts_felt; ++p) {
        Part& part = tool.parts[p];
        const auto first = static_cast<std::size_t>(result.contact_count);
        const Vector3d lifted = part.on_rigid.position() + part.on_rigid.held_back() - part.device;
        std::size_t count = 0;
        for (const GodObject::Touch& touch : part.on_rigid.touches()) {
            if (solver_.size() + count == max_contacts || first + count == max_contacts) {
                result.status |= contacts_cut;
                break;
            }
            Contact& contact = result.contacts[first + count++];
            contact = rigid_contact(touch, touch.normal, touch.normal.dot(lifted));
            contact.part = static_cast<std::int32_t>(p);
        }
        result.contact_count += static_cast<std::int32_t>(count);
        part.rigid_contacts = std::span(result.contacts).subspan(first, count);
        solver_.add(part.rigid_contacts, nullptr, static_cast<std::int32_t>(t));
    }
}

// What is in equilibrium is no farther from the device than a tool would be if nothing gave way, for there
// its energy is higher. In a narrow wedge, where the planes of contact push far beyond the surfaces that they
// stand for, a solution may be.
bool HapticModel::within_reach(const Tool& tool, const TickResult& result) const noexcept {
    double reach = unsolved;  // room for rounding
    for (const Part& part : std::span(tool.parts).first(tool.parts_felt))
        reach += (part.on_all.position() - part.device).norm() + part.moved;
    return pressed(result).norm() <= coupling_ * reach;
}

Vector3d HapticModel::solved_force(Tool& tool, const TickResult& result) const noexcept {
    Vector3d force = pressed(result);
    if (!(friction_.at_rest > 0)) return force;
    for (Part& part : std::span(tool.parts).first(tool.parts_felt)) {
        for (std::size_t soft = 0; soft < part.on_soft.size(); ++soft)
            force += friction_of(part.on_soft[soft], deformable_[soft]);
        force += friction_of(part);
    }
    return force;
}

Vector3d HapticModel::friction_of(const Part& part) const noexcept {
    double press = 0;
    for (const Contact& contact : part.rigid_contacts) press += static_cast<double>(contact.force);
    if (!(press > 0)) return Vector3d::Zero();
    Vector3d drag = -coupling_ * part.on_rigid.held_back();
    const double most = friction_.at_rest * press, wanted = drag.norm();
    if (wanted > most) drag *= most / wanted;
    for (Contact& contact : part.rigid_contacts)
        Eigen::Map<Eigen::Vector3f>(contact.friction.data()) =
            (static_cast<double>(contact.force) / press * drag).cast<float>();
    return drag;
}

// Friction drags the points in proportion to how they are pressed, by as much as it takes to move them,
// together and along with the virtual coupling, as far as the god-object is held back; by Coulomb's law at
// most. The grip that makes Coulomb's law in forces one in mm for the god-object is that of this tick, in the
// next one.
Vector3d HapticModel::friction_of(SoftTouch& touch, const DeformableContact& body) const noexcept {
    double press = 0, work = 0;
    for (const Contact& contact : touch.contacts) {
        press += static_cast<double>(contact.force);
        work += static_cast<double>(contact.force * contact.gap);
    }
    const Vector3d& held = touch.god_object.held_back();
    const double way = held.norm();
    if (!(work > 0) || !(way > 0)) return Vector3d::Zero();
    const Vector3d along = held / way;
    double compliance = 1 / coupling_;
    for (const Contact& a : touch.contacts)
        for (const Contact& b : touch.contacts)
            if (a.force > 0 && b.force > 0)
                compliance += static_cast<double>(a.force * b.force) / (press * press) *
                              body.compliance_between(a, along, b, along);
    touch.grip = compliance * press * press / work;
    const double drag = std::min(way / compliance, friction_.at_rest * press);
    for (Contact& contact : touch.contacts) {
        const double share = static_cast<double>(contact.force) / press;
        Eigen::Map<Eigen::Vector3f>(contact.friction.data()) = (-share * drag * along).cast<float>();
    }
    return -drag * along;
}

void HapticModel::finish(Tool& tool, const Vector3d& force, TickResult& result) noexcept {
    if (scheme_ == ContactScheme::continuous)
        result.tool_position = array_of(tool.parts[0].device + force / coupling_);
    result.force = array_of(tool.limiter.limit(force, result.faults, result.status));
}

void HapticModel::surface_displacement(std::size_t body, const TickResult& result,
                                       std::span<Eigen::Vector3f> displacements) const noexcept {
    deformable_[body - rigid_count()].surface_displacement(result.active_contacts(), displacements);
}

}  // namespace palpate
