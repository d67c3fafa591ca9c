// SPDX-License-Identifier: Apache-2.0
// What a haptic model checks and allocates; its tick is in haptic_tick.cpp.
#include "runtime/haptics/haptic_model.hpp"

#include <algorithm>
#include <cmath>

#include "formats/model/errors.hpp"

namespace palpate {
namespace {

constexpr double period = 1e-3;  // s

HapticSettings checked(const Case& patient_case) {
    if (const auto error = haptics_error(patient_case.haptics))
        throw InvalidInput({.culprit = patient_case.name,
                            .found = error->name + " " + error->found,
                            .expected = error->expected,
                            .next_step = "correct [haptics] in the case file and build again"});
    if (patient_case.rigid_bodies.empty() && patient_case.deformable_bodies.empty())
        throw InvalidInput({.culprit = patient_case.name,
                            .found = "the case has no body",
                            .expected = "at least one",
                            .next_step = "add a [[rigid]] or [[deformable]] body to the case file"});
    return patient_case.haptics;
}

// Where the spheres of a tool are behind its tip, mm: a radius apart, the surface of the row dips by an
// eighth of it; a long thin shaft gets fewer.
std::vector<double> spheres_of(const HapticSettings& settings) {
    constexpr double most = 48;
    const double spheres = std::min(most, std::ceil(settings.shaft_length / settings.tool_radius));
    std::vector<double> places{0};
    for (double k = 1; k <= spheres; ++k) places.push_back(settings.shaft_length * k / spheres);
    return places;
}

}  // namespace

double coupling_stiffness(const HapticSettings& settings, const DeviceLimits& device) {
    double stiffness = settings.coupling_stiffness;
    const auto limit = [&](double value, const char* name) {
        if (!(value >= 0 && std::isfinite(value)))
            throw InvalidInput(
                {"device", std::string(name) + " is " + std::to_string(value), "0 (not known) or more", ""});
        if (value > 0) stiffness = std::min(stiffness, value);
    };
    limit(device.max_stiffness, "its largest stiffness");
    limit(2 * device.damping / period, "its stability limit, 2 damping / period,");
    return stiffness;
}

HapticModel::HapticModel(const Case& patient_case, ContactScheme scheme, std::size_t tool_count)
    : settings_(checked(patient_case)),
      scheme_(scheme),
      coupling_(settings_.coupling_stiffness),
      friction_{settings_.friction_at_rest, settings_.friction_sliding} {
    for (const RigidBody& body : patient_case.rigid_bodies) {
        names_.push_back(body.name);
        surfaces_.push_back(std::make_unique<CollisionSurface>(body.surface, body.obb_tree, body.name));
        rigid_surfaces_.push_back(surfaces_.back().get());
        rigid_triangles_.push_back(body.surface.triangles);
    }
    for (const DeformableBody& body : patient_case.deformable_bodies) {
        const auto index = static_cast<std::int32_t>(names_.size());
        names_.push_back(body.name);
        surfaces_.push_back(
            std::make_unique<CollisionSurface>(body.boundary.surface, body.obb_tree, body.name));
        deformable_.emplace_back(body, index);
    }
    for (const auto& surface : surfaces_) all_surfaces_.push_back(surface.get());
    const double radius = settings_.tool_radius;
    for (std::size_t t = 0; t < tool_count; ++t) {
        Tool& tool = tools_.emplace_back(std::vector<Part>{}, ForceLimiter(settings_),
                                         std::vector<Contact>(max_contacts));
        for (const double behind_tip : spheres_of(settings_)) {
            Part& part = tool.parts.emplace_back(behind_tip, GodObject(radius, rigid_surfaces_.size()),
                                                 GodObject(radius, all_surfaces_.size()));
            for (std::size_t soft = 0; soft < deformable_.size(); ++soft)
                part.on_soft.push_back({GodObject(radius, 1)});
        }
    }
    if (scheme == ContactScheme::continuous) return;
    if (tool_count != 1)
        throw InvalidInput({patient_case.name, std::to_string(tool_count) + " tools",
                            "one tool in the published schemes", "use the scheme 'continuous'"});
    published_.emplace(patient_case, surfaces_, scheme);
}

void HapticModel::couple_to(std::span<const DeviceLimits> devices) {
    coupling_ = settings_.coupling_stiffness;
    for (const DeviceLimits& device : devices) {
        coupling_ = std::min(coupling_, coupling_stiffness(settings_, device));
        if (device.max_force > 0)
            for (Tool& tool : tools_) tool.limiter.lower_to(device.max_force);
    }
}

void HapticModel::reset() noexcept {
    for (Tool& tool : tools_) {
        forget(tool);
        tool.limiter.reset();
        tool.lost = false;
    }
    solver_.reset();
    if (published_) published_->reset();
    tick_ = 0;
}

}  // namespace palpate
