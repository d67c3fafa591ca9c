// SPDX-License-Identifier: Apache-2.0
// What the continuous contact allocates before the first tick.
#include <algorithm>
#include <cmath>

#include "formats/model/errors.hpp"
#include "runtime/haptics/methods/continuous_contact.hpp"

namespace palpate::haptics {
namespace {

std::vector<ToolSphere> spheres_of(const Case& patient_case) {
    if (has_instrument(patient_case))
        return fill_with_spheres(patient_case.tool->surface, ContinuousContact::most_spheres).spheres;
    return rod_spheres(patient_case.haptics.tool_radius, rod_length(patient_case),
                       ContinuousContact::most_of_rod);
}

// What a tool turns by under a torque, rad / (N mm); 0: as its device.
double torsion_of(const Case& patient_case) {
    return patient_case.tool ? 1 / patient_case.tool->settings.torsional_stiffness : 0;
}

}  // namespace

ContinuousContact::ContinuousContact(const Case& patient_case, const ContactBodies& bodies,
                                     std::size_t tool_count)
    : bodies_(bodies),
      spheres_(spheres_of(patient_case)),
      is_instrument_(has_instrument(patient_case)),
      friction_{patient_case.haptics.friction_at_rest, patient_case.haptics.friction_sliding,
                patient_case.haptics.grip},
      torsion_(torsion_of(patient_case)),
      equilibrium_(bodies, spheres_, is_instrument_, friction_, tool_count),
      large_(patient_case, bodies) {
    if (torsion_ > 0 && !is_instrument_ && spheres_.size() == 1)
        throw InvalidInput({patient_case.name, "its tool has no shaft, so that it has nothing to turn",
                            "a shaft", "give --rod-length, or shaft_length_mm in the case file"});
    for (const auto& surface : bodies.surfaces) {
        if (all_surfaces_.size() < bodies.rigid_count()) rigid_surfaces_.push_back(surface.get());
        all_surfaces_.push_back(surface.get());
    }
    for (std::size_t t = 0; t < tool_count; ++t) {
        Tool& tool = tools_.emplace_back();
        tool.waits = torsion_ > 0;
        for (const ToolSphere& sphere : spheres_)
            tool.parts.emplace_back(GodObject(sphere.radius, rigid_surfaces_.size()),
                                    GodObject(sphere.radius, all_surfaces_.size()));
        if (spheres_.size() == 1 && torsion_ == 0)
            along_.push_back({WallFollower(spheres_[0].radius, rigid_surfaces_.size())});
    }
}

ContinuousContact::~ContinuousContact() = default;

void ContinuousContact::reset() noexcept {
    for (std::size_t t = 0; t < tools_.size(); ++t) forget(t);
    large_.reset(equilibrium_);
    equilibrium_.reset();
}

void ContinuousContact::detect() noexcept {
    if (large_.any()) large_.answer();
}

void ContinuousContact::keep_forces() {
    large_.keep_forces();
}

void ContinuousContact::detect_at(const std::array<double, 3>& /*device*/, std::int64_t tick) noexcept {
    if (large_.any()) large_.answer_tick(tick);
}

void ContinuousContact::add_beyond(std::size_t soft, std::span<const TickResult* const> results,
                                   std::span<Eigen::Vector3f> displacements) {
    large_.add_beyond(soft, results, displacements);
}

std::unique_ptr<ContactMethod> make_continuous(const Case& patient_case, const ContactBodies& bodies,
                                               std::size_t tool_count) {
    return std::make_unique<ContinuousContact>(patient_case, bodies, tool_count);
}

}  // namespace palpate::haptics
