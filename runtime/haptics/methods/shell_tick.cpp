// SPDX-License-Identifier: Apache-2.0
// A tick of a whole tool against rigid bodies.
#include <algorithm>
#include <array>
#include <limits>

#include "formats/model/arrays.hpp"
#include "runtime/haptics/methods/shell_contact.hpp"

namespace palpate::haptics {

using Eigen::Vector3d;

void ShellContact::reset() noexcept {
    for (Tool& tool : tools_) {
        tool.watch.reset();
        tool.placed = tool.waits = false;
    }
}

void ShellContact::tick(std::span<const ContactPose> poses, double coupling, std::span<TickResult> results,
                        std::span<Vector3d> forces) noexcept {
    for (std::size_t t = 0; t < tools_.size(); ++t) {
        if (!poses[t].trusted) continue;
        Tool& tool = tools_[t];
        const ToolPose device{poses[t].tip, orientation_of(poses[t])};
        if (!stays_clear(tool, poses[t], device, results[t])) continue;
        const ShellRest rest = bring_to_rest(tool.watch, {device, coupling, settings_.torsional_stiffness},
                                             settings_.contact_stiffness, longest_step(settings_), tool.pose);
        if (rest == ShellRest::unsettled) results[t].status |= contact_unsettled;
        if (!tool.watch.touches() && rest != ShellRest::on_its_way) {
            tool.pose = device;  // to the bit, so that a replay may begin in any free tick
        } else {
            forces[t] = coupling * (tool.pose.position - device.position);
            results[t].torque = array_of(Vector3d(
                settings_.torsional_stiffness * rotation_between(device.orientation, tool.pose.orientation)));
        }
        tell(tool, device, results[t]);
    }
}

// Whether the tool has been clear of every body since it was placed; until then it is where its device is.
bool ShellContact::stays_clear(Tool& tool, const ContactPose& at, const ToolPose& device,
                               TickResult& result) noexcept {
    if (!tool.placed || at.jumped) {
        tool.watch.reset();
        tool.placed = tool.waits = true;
    }
    if (!tool.waits) return true;
    tool.pose = device;
    tool.watch.look(device);
    tool.waits = tool.watch.touches();
    if (!tool.waits) return true;
    result.status |= starts_inside;
    result.tool_orientation = array_of(device.orientation);
    return false;
}

// What a result says of where the tool is and what it touches.
void ShellContact::tell(Tool& tool, const ToolPose& device, TickResult& result) const noexcept {
    result.tool_position = array_of(tool.pose.position);
    result.tool_orientation = array_of(tool.pose.orientation);
    std::array<ShellTouch, most_told> deepest;
    const auto found = std::ranges::partial_sort_copy(tool.watch.close(), deepest, {}, &ShellTouch::distance,
                                                      &ShellTouch::distance);
    for (const ShellTouch& touch : std::span(deepest.begin(), found.out)) {
        if (touch.distance >= 0) break;
        if (result.contact_count == 0) {
            result.residual = -touch.distance;
            result.body = touch.body;
        }
        result.contacts[static_cast<std::size_t>(result.contact_count++)] = contact_of(tool, touch);
        result.depth = std::max(result.depth, depth_at(device, touch));
    }
}

// How deep the device has a point of the tool below the body that it touches.
double ShellContact::depth_at(const ToolPose& device, const ShellTouch& touch) const noexcept {
    const collision::CollisionSurface& surface = *bodies_.surfaces[static_cast<std::size_t>(touch.body)];
    const Vector3d held = points_[static_cast<std::size_t>(touch.point)].position.cast<double>();
    const Vector3d p = device.position + device.orientation * held;
    const auto nearest = surface.closest_point(p, std::numeric_limits<double>::max());
    return nearest && !surface.is_outside(p, *nearest) ? nearest->distance : 0;
}

Contact ShellContact::contact_of(Tool& tool, const ShellTouch& touch) const noexcept {
    const auto body = static_cast<std::size_t>(touch.body);
    const double steepness = touch.gradient().norm();
    const Vector3d normal = steepness > 0 ? Vector3d(touch.gradient() / steepness) : Vector3d::UnitZ();
    Contact contact;
    contact.body = touch.body;
    contact.part = touch.point;
    contact.gap = static_cast<float>(-touch.distance);
    contact.force = static_cast<float>(-settings_.contact_stiffness * touch.distance * steepness);
    Eigen::Map<Eigen::Vector3f>(contact.normal.data()) = normal.cast<float>();
    contact.triangle = -1;
    const collision::DistanceField& field = fields_[body];
    const auto nearest = bodies_.surfaces[body]->closest_point(
        tool.pose.position + touch.arm, -touch.distance + 2 * field.error(), tool.hints[body]);
    if (!nearest) return contact;
    tool.hints[body] = nearest->slot;
    contact.triangle = nearest->triangle;
    contact.vertices = bodies_.triangles[body][static_cast<std::size_t>(nearest->triangle)];
    Eigen::Map<Eigen::Vector3f>(contact.weights.data()) = nearest->barycentric.cast<float>();
    return contact;
}

}  // namespace palpate::haptics
