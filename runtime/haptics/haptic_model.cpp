// SPDX-License-Identifier: Apache-2.0
#include "runtime/haptics/haptic_model.hpp"

#include <algorithm>
#include <cmath>

#include "formats/model/errors.hpp"

namespace palpate {
namespace {

using Eigen::Vector3d;

HapticSettings checked(const Case& patient_case) {
    const HapticSettings& s = patient_case.haptics;
    const auto require = [&](double value, const char* name, const char* unit) {
        if (std::isfinite(value) && value > 0) return;
        throw InvalidInput({.culprit = patient_case.name,
                            .found = std::string(name) + " is " + std::to_string(value) + " " + unit,
                            .expected = "more than 0",
                            .next_step = "correct [haptics] in the case file and build again"});
    };
    require(s.tool_radius, "tool_radius", "mm");
    require(s.coupling_stiffness, "coupling_stiffness", "N/mm");
    require(s.max_force, "max_force", "N");
    require(s.max_force_rate, "max_force_rate", "N per tick");
    if (patient_case.rigid_bodies.empty() && patient_case.deformable_bodies.empty())
        throw InvalidInput({.culprit = patient_case.name,
                            .found = "the case has no body",
                            .expected = "at least one",
                            .next_step = "add a [[rigid]] or [[deformable]] body to the case file"});
    return s;
}

std::array<double, 3> array_of(const Vector3d& v) noexcept {
    return {v[0], v[1], v[2]};
}

}  // namespace

HapticModel::HapticModel(const Case& patient_case)
    : settings_(checked(patient_case)), limiter_(patient_case.haptics) {
    for (const RigidBody& body : patient_case.rigid_bodies) {
        names_.push_back(body.name);
        surfaces_.push_back(std::make_unique<CollisionSurface>(body.surface, body.obb_tree, body.name));
        rigid_triangles_.push_back(body.surface.triangles);
    }
    for (const DeformableBody& body : patient_case.deformable_bodies) {
        const auto index = static_cast<std::int32_t>(names_.size());
        names_.push_back(body.name);
        surfaces_.push_back(
            std::make_unique<CollisionSurface>(body.boundary.surface, body.obb_tree, body.name));
        deformable_.emplace_back(body, index, settings_);
    }
    god_objects_.assign(surfaces_.size(), GodObject(settings_.tool_radius));
}

void HapticModel::reset() noexcept {
    for (GodObject& god_object : god_objects_) god_object.reset();
    limiter_.reset();
    tick_ = 0;
}

void HapticModel::tick(const DeviceState& state, TickResult& result) noexcept {
    result.tick = tick_++;
    result.time = state.time;
    result.device_position = state.position;
    result.tool_position = state.position;
    result.depth = 0;
    result.residual = 0;
    result.body = -1;
    result.contact_count = 0;
    result.status = tick_ok;

    const Eigen::Map<const Vector3d> device(state.position.data());
    if (!state.connected || !device.allFinite()) {
        result.status = invalid_position;
        result.force = array_of(limiter_.ramp_to_zero());
        return;
    }
    Vector3d force = Vector3d::Zero();
    for (std::size_t body = 0; body < surfaces_.size(); ++body) {
        GodObject& god_object = god_objects_[body];
        if (!god_object.move(*surfaces_[body], device)) result.status |= starts_inside;
        if (god_object.touches().empty()) continue;
        const double depth = (god_object.position() - device).norm();
        force += body < rigid_count() ? touch_rigid(body, device, depth, result)
                                      : touch_deformable(body, device, result);
        if (depth <= result.depth) continue;
        result.depth = depth;
        result.body = static_cast<std::int32_t>(body);
    }
    result.force = array_of(limiter_.limit(force, result.status));
}

Vector3d HapticModel::touch_rigid(std::size_t body, const Vector3d& device, double depth,
                                  TickResult& result) noexcept {
    const GodObject& god_object = god_objects_[body];
    const Vector3d force = settings_.coupling_stiffness * (god_object.position() - device);
    // Rigid bodies come first, so result.depth is that of the deepest rigid one so far.
    if (depth > result.depth) result.tool_position = array_of(god_object.position());
    if (static_cast<std::size_t>(result.contact_count) == max_contacts) {
        result.status |= contacts_cut;
        return force;
    }
    const ClosestPoint& foot = god_object.touches().front().foot;
    Contact& contact = result.contacts[static_cast<std::size_t>(result.contact_count++)];
    contact.body = static_cast<std::int32_t>(body);
    contact.triangle = foot.triangle;
    contact.vertices = rigid_triangles_[body][static_cast<std::size_t>(foot.triangle)];
    Eigen::Map<Eigen::Vector3f>(contact.weights.data()) = foot.barycentric.cast<float>();
    Eigen::Map<Eigen::Vector3f>(contact.normal.data()) = (force / force.norm()).cast<float>();
    contact.gap = static_cast<float>(depth);
    contact.force = static_cast<float>(force.norm());
    contact.series_compliance = static_cast<float>(1 / settings_.coupling_stiffness);
    return force;
}

Vector3d HapticModel::touch_deformable(std::size_t body, const Vector3d& device,
                                       TickResult& result) noexcept {
    const DeformableContact::Outcome outcome = deformable_[body - rigid_count()].solve(
        *surfaces_[body], god_objects_[body], device, result.contacts, result.contact_count);
    result.status |= outcome.status;
    result.residual = std::max(result.residual, outcome.residual);
    return outcome.force;
}

void HapticModel::surface_displacement(std::size_t body, const TickResult& result,
                                       std::span<Eigen::Vector3f> displacements) const noexcept {
    deformable_[body - rigid_count()].surface_displacement(result.active_contacts(), displacements);
}

}  // namespace palpate
