// SPDX-License-Identifier: Apache-2.0
// One tick of a haptic model: nothing here allocates, locks, waits or throws.
#include <algorithm>
#include <cmath>

#include "runtime/haptics/haptic_model.hpp"

namespace palpate {
namespace {

using Eigen::Vector3d;

constexpr double unsolved = 1e-3;      // mm of residual that is reported
constexpr double beside_surface = 10;  // mm: farther from a body than this, its motion does not matter

std::array<double, 3> array_of(const Vector3d& v) noexcept {
    return {v[0], v[1], v[2]};
}

Vector3d vector_of(const std::array<double, 3>& v) noexcept {
    return Eigen::Map<const Vector3d>(v.data());
}

}  // namespace

void HapticModel::detect() noexcept {
    if (published_) published_->detect();
}

void HapticModel::tick(std::span<const DeviceState> devices, std::span<TickResult> results) noexcept {
    solver_.clear();
    for (std::size_t t = 0; t < tools_.size(); ++t) {
        results[t].tool = static_cast<std::int32_t>(t);
        begin(tools_[t], devices[t], results[t]);
    }
    ++tick_;
    if (published_) {
        if (tools_[0].present)
            finish(tools_[0], published_->tick(tools_[0].device, coupling_, results[0]), results[0]);
        return;
    }
    for (std::size_t t = 0; t < tools_.size(); ++t)
        if (tools_[t].present) follow(t, results[t]);
    const double residual = solver_.size() > 0 ? solver_.solve(1 / coupling_) : 0;
    for (std::size_t t = 0; t < tools_.size(); ++t) {
        Tool& tool = tools_[t];
        TickResult& result = results[t];
        if (!tool.present) continue;
        const bool soft =
            std::ranges::any_of(tool.on_soft, [](const SoftTouch& touch) { return !touch.contacts.empty(); });
        if (soft) {
            result.residual = residual;
            if (!(residual <= unsolved)) result.status |= contact_unsolved;
        }
        finish(tool, soft ? contact_force(tool, result) : rigid_force(tool, result), result);
        if (tools_.size() == 1) continue;
        const auto contacts = result.active_contacts();
        tool.last_contacts.assign(contacts.begin(), contacts.end());
    }
}

void HapticModel::begin(Tool& tool, const DeviceState& device, TickResult& result) noexcept {
    result.tick = tick_;
    result.time = device.time;
    result.device_position = result.tool_position = device.position;
    result.depth = 0;
    result.residual = 0;
    result.body = -1;
    result.contact_count = 0;
    result.status = tick_ok;
    for (SoftTouch& touch : tool.on_soft) touch.contacts = {};
    tool.device = vector_of(device.position);
    tool.present = device.connected && tool.device.allFinite();
    if (tool.present) return;
    result.status = invalid_position;
    result.force = array_of(tool.limiter.ramp_to_zero());
    tool.last_contacts.clear();
}

// Moves the tool's god-objects and gathers the contact points that must be solved.
void HapticModel::follow(std::size_t t, TickResult& result) noexcept {
    Tool& tool = tools_[t];
    if (!tool.on_rigid.move(rigid_surfaces_, tool.device, friction_)) result.status |= starts_inside;
    if (!tool.on_rigid.touches().empty()) {
        result.depth = (tool.on_rigid.position() - tool.device).norm();
        result.body = static_cast<std::int32_t>(tool.on_rigid.touches().front().surface);
    }
    for (std::size_t soft = 0; soft < deformable_.size(); ++soft) follow_soft(t, soft, result);
    if (std::ranges::any_of(tool.on_soft, [](const SoftTouch& touch) { return !touch.contacts.empty(); }))
        add_rigid_contacts(t, result);
}

// A tool that rigid bodies hold off goes no deeper into soft ones. On a surface that other contacts have
// moved, its god-object moves as if the surface were at rest and the tool had moved the other way.
void HapticModel::follow_soft(std::size_t t, std::size_t soft, TickResult& result) noexcept {
    Tool& tool = tools_[t];
    SoftTouch& touch = tool.on_soft[soft];
    const DeformableContact& body = deformable_[soft];
    const CollisionSurface& surface = *surfaces_[rigid_count() + soft];
    const CollisionSurface* const alone = &surface;
    const Vector3d& wanted = tool.on_rigid.position();
    const Vector3d goal = wanted - moved_by_others(t, soft, wanted);
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
        body.collect(surface, touch.god_object, goal - held, tool.device - held, points, result.status);
    touch.contacts = points.first(count);
    result.contact_count += static_cast<std::int32_t>(count);
    std::int32_t foot = 0;
    for (Contact& contact : touch.contacts)
        solver_.add(contact, &body, static_cast<std::int32_t>(t), contact.triangle < 0 ? 0 : foot++);
    const double depth = (touch.god_object.position() - goal).norm();
    if (depth <= result.depth) return;
    result.depth = depth;
    result.body = body.body_index();
}

// How far the contacts of the other tools, as of the last tick, have moved a body's surface beside `place`,
// mm.
Vector3d HapticModel::moved_by_others(std::size_t t, std::size_t soft, const Vector3d& place) const noexcept {
    Vector3d moved = Vector3d::Zero();
    if (tools_.size() == 1) return moved;
    const auto foot = surfaces_[rigid_count() + soft]->closest_point(place, beside_surface);
    if (!foot) return moved;
    const DeformableContact& body = deformable_[soft];
    const Contact point = body.point_on(*foot);
    for (std::size_t other = 0; other < tools_.size(); ++other)
        if (other != t) moved += body.displacement_at(point, tools_[other].last_contacts);
    return moved;
}

// Where only rigid bodies are touched, the spring to the god-object says it all.
Vector3d HapticModel::rigid_force(Tool& tool, TickResult& result) const noexcept {
    if (tool.on_rigid.touches().empty()) return Vector3d::Zero();
    const Vector3d force = coupling_ * (tool.on_rigid.position() - tool.device);
    const double magnitude = force.norm();
    const GodObject::Touch& touch = tool.on_rigid.touches().front();
    Contact& contact = result.contacts[static_cast<std::size_t>(result.contact_count++)];
    contact = Contact{};
    contact.body = static_cast<std::int32_t>(touch.surface);
    contact.triangle = touch.foot.triangle;
    contact.vertices = rigid_triangles_[touch.surface][static_cast<std::size_t>(touch.foot.triangle)];
    Eigen::Map<Eigen::Vector3f>(contact.weights.data()) = touch.foot.barycentric.cast<float>();
    // Of several walls that hold the tool, one record: the resultant, less friction.
    const Vector3d drag = -coupling_ * tool.on_rigid.held_back();
    const Vector3d press = force - drag;
    Eigen::Map<Eigen::Vector3f>(contact.normal.data()) = press.normalized().cast<float>();
    Eigen::Map<Eigen::Vector3f>(contact.friction.data()) = drag.cast<float>();
    contact.gap = static_cast<float>(magnitude / coupling_);
    contact.force = static_cast<float>(press.norm());
    return force;
}

// The rigid bodies' hold on a tool that touches soft ones too.
void HapticModel::add_rigid_contacts(std::size_t t, TickResult& result) noexcept {
    const GodObject& god_object = tools_[t].on_rigid;
    const Vector3d lifted = god_object.position() + god_object.held_back() - tools_[t].device;
    std::int32_t foot = 0;
    for (const GodObject::Touch& touch : god_object.touches()) {
        if (solver_.size() == max_contacts ||
            static_cast<std::size_t>(result.contact_count) == max_contacts) {
            result.status |= contacts_cut;
            return;
        }
        Contact& contact = result.contacts[static_cast<std::size_t>(result.contact_count++)];
        contact = Contact{};
        contact.body = static_cast<std::int32_t>(touch.surface);
        contact.triangle = touch.foot.triangle;
        contact.vertices = rigid_triangles_[touch.surface][static_cast<std::size_t>(touch.foot.triangle)];
        Eigen::Map<Eigen::Vector3f>(contact.weights.data()) = touch.foot.barycentric.cast<float>();
        Eigen::Map<Eigen::Vector3f>(contact.normal.data()) = touch.normal.cast<float>();
        contact.gap = static_cast<float>(touch.normal.dot(lifted));
        solver_.add(contact, nullptr, static_cast<std::int32_t>(t), foot++);
    }
}

// Sums the solved contacts and lets friction drag on them.
Vector3d HapticModel::contact_force(Tool& tool, TickResult& result) noexcept {
    Vector3d force = Vector3d::Zero();
    double rigid_press = 0;
    for (const Contact& contact : result.active_contacts()) {
        force += static_cast<double>(contact.force) * normal_of(contact);
        if (static_cast<std::size_t>(contact.body) < rigid_count())
            rigid_press += static_cast<double>(contact.force);
    }
    if (!(friction_.at_rest > 0)) return force;
    for (std::size_t soft = 0; soft < tool.on_soft.size(); ++soft)
        force += feel_friction(tool.on_soft[soft], deformable_[soft]);
    Vector3d drag = -coupling_ * tool.on_rigid.held_back();
    const double most = friction_.at_rest * rigid_press;
    if (drag.norm() > most) drag *= most / drag.norm();
    return force + drag;
}

// Friction drags the points in proportion to how they are pressed, by as much as it takes to move them,
// together and along with the virtual coupling, as far as the god-object is held back; by Coulomb's law at
// most. The grip that makes Coulomb's law in forces one in mm for the god-object is that of this tick, in the
// next one.
Vector3d HapticModel::feel_friction(SoftTouch& touch, const DeformableContact& body) const noexcept {
    const Vector3d& held = touch.god_object.held_back();
    double press = 0, gap = 0;
    for (const Contact& contact : touch.contacts) {
        press += static_cast<double>(contact.force);
        gap += static_cast<double>(contact.force * contact.gap);
    }
    const double way = held.norm();
    if (!(press > 0) || !(way > 0)) return Vector3d::Zero();
    const Vector3d along = held / way;
    double compliance = 1 / coupling_;
    for (const Contact& a : touch.contacts)
        for (const Contact& b : touch.contacts)
            if (a.force > 0 && b.force > 0)
                compliance += static_cast<double>(a.force * b.force) / (press * press) *
                              body.compliance_between(a, along, b, along);
    touch.grip = compliance * press * press / gap;
    const double drag = std::min(way / compliance, friction_.at_rest * press);
    for (Contact& contact : touch.contacts) {
        const double share = static_cast<double>(contact.force) / press;
        Eigen::Map<Eigen::Vector3f>(contact.friction.data()) = (-share * drag * along).cast<float>();
    }
    return -drag * along;
}

void HapticModel::finish(Tool& tool, const Vector3d& force, TickResult& result) noexcept {
    if (scheme_ == ContactScheme::continuous)
        result.tool_position = array_of(tool.device + force / coupling_);
    result.force = array_of(tool.limiter.limit(force, result.status));
}

void HapticModel::surface_displacement(std::size_t body, const TickResult& result,
                                       std::span<Eigen::Vector3f> displacements) const noexcept {
    deformable_[body - rigid_count()].surface_displacement(result.active_contacts(), displacements);
}

}  // namespace palpate
