// SPDX-License-Identifier: Apache-2.0
// What the continuous contact allocates before the first tick.
#include <algorithm>
#include <cmath>

#include "formats/model/errors.hpp"
#include "runtime/haptics/methods/continuous_contact.hpp"

namespace palpate::haptics {
namespace {

// Where the spheres of a tool are behind its tip, mm: a radius apart, the surface of the row dips by an
// eighth of it; a long thin shaft gets fewer.
std::vector<double> spheres_of(const HapticSettings& settings, std::size_t most_spheres) {
    const auto most = static_cast<double>(most_spheres - 1);
    const double spheres = std::min(most, std::ceil(settings.shaft_length / settings.tool_radius));
    std::vector<double> places{0};
    for (double k = 1; k <= spheres; ++k) places.push_back(settings.shaft_length * k / spheres);
    return places;
}

}  // namespace

ContinuousContact::ContinuousContact(const Case& patient_case, const ContactBodies& bodies,
                                     const HapticSettings& settings, std::size_t tool_count, double torsion)
    : bodies_(bodies),
      friction_{settings.friction_at_rest, settings.friction_sliding, settings.grip},
      torsion_(torsion),
      equilibrium_(bodies, settings.tool_radius, friction_, tool_count,
                   spheres_of(settings, most_spheres).size()),
      large_(patient_case, bodies) {
    for (const auto& surface : bodies.surfaces) {
        if (all_surfaces_.size() < bodies.rigid_count()) rigid_surfaces_.push_back(surface.get());
        all_surfaces_.push_back(surface.get());
    }
    const double radius = settings.tool_radius;
    for (std::size_t t = 0; t < tool_count; ++t) {
        Tool& tool = tools_.emplace_back(std::vector<Part>{});
        for (const double behind_tip : spheres_of(settings, most_spheres))
            tool.parts.emplace_back(behind_tip, GodObject(radius, rigid_surfaces_.size()),
                                    GodObject(radius, all_surfaces_.size()));
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
    if (has_instrument(patient_case))
        throw InvalidInput(
            {patient_case.name,
             "a tool with a surface of its own, which contact method 'continuous' does not feel",
             "the case's ball or rod", "use contact method 'shell'"});
    const double torsion = patient_case.tool ? 1 / patient_case.tool->settings.torsional_stiffness : 0;
    HapticSettings settings = patient_case.haptics;
    settings.shaft_length = rod_length(patient_case);
    if (patient_case.tool && !(settings.shaft_length > 0))
        throw InvalidInput({patient_case.name, "its tool has no shaft, so that it has nothing to turn",
                            "a shaft", "give --rod-length, or shaft_length_mm in the case file"});
    return std::make_unique<ContinuousContact>(patient_case, bodies, settings, tool_count, torsion);
}

}  // namespace palpate::haptics
