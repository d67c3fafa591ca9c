// SPDX-License-Identifier: Apache-2.0
// What a whole tool against rigid bodies is made of: fields and points.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <thread>

#include "formats/model/errors.hpp"
#include "runtime/haptics/methods/shell_contact.hpp"
#include "runtime/haptics/whole_tool/rod.hpp"

namespace palpate::haptics {
namespace {

constexpr double fewest_points = 100;  // of a rod

std::vector<collision::ShellPoint> points_of(const Case& patient_case, const ToolSettings& settings) {
    if (has_instrument(patient_case))
        return collision::point_shell(patient_case.tool->surface,
                                      static_cast<std::size_t>(settings.shell_points))
            .points;
    const double radius = patient_case.haptics.tool_radius, length = rod_length(patient_case);
    const double area = 2 * std::numbers::pi * radius * (2 * radius + length);
    // Half a voxel apart; a small ball needs no thousands.
    const double wanted = std::clamp(area / (0.25 * settings.voxel * settings.voxel), fewest_points,
                                     static_cast<double>(settings.shell_points));
    return collision::point_shell(rod_surface(radius, length), static_cast<std::size_t>(wanted)).points;
}

collision::DistanceField field_of(const ContactBodies& bodies, std::size_t body, double voxel, double band) {
    const std::size_t threads = std::max(1U, std::thread::hardware_concurrency());
    try {
        return {*bodies.surfaces[body], voxel, band, threads};
    } catch (const InvalidInput& error) {
        const auto& [culprit, found, expected, next_step] = error.detail();
        throw InvalidInput({bodies.names[body] + ", " + culprit, found, expected, "--voxel: " + next_step});
    }
}

}  // namespace

ShellContact::ShellContact(const Case& patient_case, const ContactBodies& bodies, std::size_t tool_count)
    : WholeToolContact(bodies, whole_tool_settings(patient_case, "shell"), tool_count),
      points_(points_of(patient_case, settings_)) {
    fields_.reserve(bodies.rigid_count());
    // So deep that a single point still holds a tool whose device is that far inside.
    constexpr double deepest_device = 50;  // mm
    const double band =
        std::max(band_voxels * settings_.voxel,
                 deepest_device * patient_case.haptics.coupling_stiffness / settings_.contact_stiffness);
    for (std::size_t body = 0; body < bodies.rigid_count(); ++body)
        fields_.push_back(field_of(bodies, body, settings_.voxel, band));
    for (std::size_t t = 0; t < tool_count; ++t)
        watches_.emplace_back(points_, fields_, longest_step(settings_));
}

ShellContact::~ShellContact() = default;

std::unique_ptr<ContactMethod> make_shell(const Case& patient_case, const ContactBodies& bodies,
                                          std::size_t tool_count) {
    return std::make_unique<ShellContact>(patient_case, bodies, tool_count);
}

}  // namespace palpate::haptics
