// SPDX-License-Identifier: Apache-2.0
#include "runtime/doctor/checks/case_checks.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <functional>

#include "runtime/devices/device_model.hpp"
#include "runtime/haptics/haptic_model.hpp"

namespace palpate::doctor {
namespace {

using namespace devices;

constexpr const char* case_group = "case";
using Edges = std::array<double, 3>;  // of a box, mm, longest first

Edges sorted_edges(const Eigen::Vector3d& size) {
    Edges edges{size[0], size[1], size[2]};
    std::ranges::sort(edges, std::greater());
    return edges;
}

Edges workspace_of(const DeviceModel& model) {
    return sorted_edges(Eigen::Map<const Eigen::Vector3d>(model.workspace_high.data()) -
                        Eigen::Map<const Eigen::Vector3d>(model.workspace_low.data()));
}

std::string told(const Edges& edges) {
    return fmt::format("{:.0f} x {:.0f} x {:.0f} mm", edges[0], edges[1], edges[2]);
}

// Of the box around what can be touched of a body.
Edges extent(const DeformableBody& body) {
    Eigen::AlignedBox3d box;
    for (const std::int32_t node : body.contact_nodes) box.extend(body.mesh.rest_positions[node]);
    return sorted_edges(box.isEmpty() ? Eigen::Vector3d::Zero() : Eigen::Vector3d(box.sizes()));
}

Edges extent(const RigidBody& body) {
    Eigen::AlignedBox3d box;
    for (const Eigen::Vector3d& vertex : body.surface.vertices) box.extend(vertex);
    return sorted_edges(box.isEmpty() ? Eigen::Vector3d::Zero() : Eigen::Vector3d(box.sizes()));
}

bool fits(const Edges& body, const Edges& workspace) {
    return std::ranges::equal(body, workspace, std::less_equal());
}

Finding workspace(const Case& patient_case, const DeviceModel& model) {
    const Edges room = workspace_of(model);
    Finding finding{"workspace." + model.name, case_group, Level::ok, "reaches " + told(room), ""};
    const auto hold = [&](const std::string& body, const Edges& edges, bool soft) {
        const bool inside = fits(edges, room);
        finding.found += fmt::format("; {} {}{}", body, told(edges),
                                     inside ? ""
                                     : soft ? " is larger"
                                            : " is larger, and rigid");
        if (!inside && soft) finding.level = Level::warning;
    };
    for (const DeformableBody& body : patient_case.deformable_bodies) hold(body.name, extent(body), true);
    for (const RigidBody& body : patient_case.rigid_bodies) hold(body.name, extent(body), false);
    if (finding.level == Level::warning)
        finding.fix =
            "# only the part about the device's middle can be touched; choose which with\n"
            "palpate train case.vtkhdf --body NAME";
    return finding;
}

Finding rendering(const HapticSettings& asked, const DeviceModel& model) {
    const DeviceLimits limits{
        .max_force = model.max_force, .max_stiffness = model.max_stiffness, .damping = model.damping};
    const double stiffness = haptics::coupling_stiffness(asked, limits);
    const double force = std::min(asked.max_force, model.max_force);
    Finding finding{
        "rendering." + model.name, case_group, Level::ok,
        fmt::format("renders the {} N/mm and {} N asked for", asked.coupling_stiffness, asked.max_force), ""};
    if (stiffness < asked.coupling_stiffness || force < asked.max_force) {
        finding.level = Level::warning;
        finding.found = fmt::format("{} N/mm and {} N asked for, {} N/mm and {} N rendered",
                                    asked.coupling_stiffness, asked.max_force, stiffness, force);
        finding.fix = fmt::format(
            "# is done when it runs; to have it in the case file, in [haptics]:\n"
            "# coupling_stiffness_n_per_mm = {}\n# max_force_n = {}",
            stiffness, force);
    }
    return finding;
}

}  // namespace

Findings case_findings(const Case& patient_case) {
    Findings findings;
    for (const DeviceModel& model : device_models()) {
        findings.push_back(workspace(patient_case, model));
        findings.push_back(rendering(patient_case.haptics, model));
    }
    return findings;
}

}  // namespace palpate::doctor
