// SPDX-License-Identifier: Apache-2.0
// A tick of a whole tool against rigid bodies, however touches are found.
#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <span>

#include "formats/model/arrays.hpp"
#include "runtime/haptics/methods/whole_tool_contact.hpp"

namespace palpate::haptics {

using Eigen::Vector3d;

namespace {

// Whether what is left of the way is no more than a search leaves that ends.
bool has_arrived(const ToolPose& pose, const ToolPose& device) noexcept {
    constexpr double left = 1e-3, left_turn = 1e-5;  // mm, rad
    return (pose.position - device.position).norm() <= left &&
           rotation_between(device.orientation, pose.orientation).norm() <= left_turn;
}

}  // namespace

void WholeToolContact::reset() noexcept {
    for (std::size_t t = 0; t < tools_.size(); ++t) {
        forget(t);
        tools_[t].placed = tools_[t].waits = false;
    }
}

void WholeToolContact::tick(std::span<const ContactPose> poses, const VirtualCoupling& coupling,
                            std::span<TickResult> results, std::span<Vector3d> forces) noexcept {
    for (std::size_t t = 0; t < tools_.size(); ++t) {
        if (!poses[t].trusted) continue;
        const ToolPose device{poses[t].tip, orientation_of(poses[t])};
        if (!stays_clear(t, poses[t], device, results[t])) continue;
        ToolPose& pose = tools_[t].pose;
        const ToolRest rest =
            bring_to_rest(t, {device, coupling.stiffness, coupling.torsional_stiffness}, pose);
        if (rest == ToolRest::unsettled) results[t].status |= contact_unsettled;
        const bool presses =
            std::ranges::any_of(touches(t), [](const ToolTouch& it) { return it.press > 0; });
        if (!presses && has_arrived(pose, device)) {
            pose = device;  // to the bit, so that a replay may begin in any free tick
            set_free(t);
        } else {
            forces[t] = coupling.stiffness * (pose.position - device.position);
            results[t].torque = array_of(Vector3d(coupling.torsional_stiffness *
                                                  rotation_between(device.orientation, pose.orientation)));
        }
        tell(t, device, results[t]);
    }
}

bool WholeToolContact::is_outside_all(const Vector3d& p) const noexcept {
    return std::ranges::all_of(std::span(bodies_.surfaces).first(bodies_.rigid_count()),
                               [&](const auto& surface) { return surface->is_outside(p); });
}

// Whether the tool has been clear of every body since it was placed; until then it is where its device is.
bool WholeToolContact::stays_clear(std::size_t t, const ContactPose& at, const ToolPose& device,
                                   TickResult& result) noexcept {
    Tool& tool = tools_[t];
    if (!tool.placed || at.jumped) {
        forget(t);
        tool.placed = tool.waits = true;
    }
    if (!tool.waits) return true;
    tool.pose = device;
    tool.waits = !is_clear(t, device);
    if (!tool.waits) return true;
    result.status |= starts_inside;
    result.tool_orientation = array_of(device.orientation);
    return false;
}

// What a result says of where the tool is and what it touches.
void WholeToolContact::tell(std::size_t t, const ToolPose& device, TickResult& result) noexcept {
    Tool& tool = tools_[t];
    result.tool_position = array_of(tool.pose.position);
    result.tool_orientation = array_of(tool.pose.orientation);
    std::array<ToolTouch, most_told> hardest;
    const auto found = std::ranges::partial_sort_copy(touches(t), hardest, std::greater{}, &ToolTouch::press,
                                                      &ToolTouch::press);
    for (const ToolTouch& touch : std::span(hardest.begin(), found.out)) {
        if (!(touch.press > 0)) break;
        if (result.contact_count == 0) result.body = touch.body;
        result.residual = std::max(result.residual, depth_of(touch));
        result.contacts[static_cast<std::size_t>(result.contact_count++)] = contact_of(tool, touch);
        result.depth = std::max(result.depth, depth_at(tool, device, touch));
    }
}

// How deep the device has a point of the tool below the body that it touches.
double WholeToolContact::depth_at(const Tool& tool, const ToolPose& device,
                                  const ToolTouch& touch) const noexcept {
    const collision::CollisionSurface& surface = *bodies_.surfaces[static_cast<std::size_t>(touch.body)];
    const Vector3d held = tool.pose.orientation.conjugate() * touch.arm;
    const Vector3d p = device.position + device.orientation * held;
    const auto nearest = surface.closest_point(p, std::numeric_limits<double>::max());
    return nearest && !surface.is_outside(p, *nearest) ? nearest->distance : 0;
}

Contact WholeToolContact::contact_of(Tool& tool, const ToolTouch& touch) const noexcept {
    const auto body = static_cast<std::size_t>(touch.body);
    const double steepness = touch.gradient().norm();
    const Vector3d normal = steepness > 0 ? Vector3d(touch.gradient() / steepness) : Vector3d::UnitZ();
    Contact contact;
    contact.body = touch.body;
    contact.part = touch.point;
    contact.gap = static_cast<float>(depth_of(touch));
    contact.force = static_cast<float>(touch.press);
    Eigen::Map<Eigen::Vector3f>(contact.normal.data()) = normal.cast<float>();
    contact.triangle = -1;
    const auto nearest = bodies_.surfaces[body]->closest_point(tool.pose.position + touch.arm,
                                                               surface_within(touch), tool.hints[body]);
    if (!nearest) return contact;
    tool.hints[body] = nearest->slot;
    contact.triangle = nearest->triangle;
    contact.vertices = bodies_.triangles[body][static_cast<std::size_t>(nearest->triangle)];
    Eigen::Map<Eigen::Vector3f>(contact.weights.data()) = nearest->barycentric.cast<float>();
    return contact;
}

}  // namespace palpate::haptics
