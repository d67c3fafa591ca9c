// SPDX-License-Identifier: Apache-2.0
// What a whole tool by normal cones is made of: features and trees of both sides.
#include <algorithm>

#include "runtime/haptics/methods/cone_contact.hpp"

namespace palpate::haptics {
namespace {

// So far from a surface a single minimum gives the largest force before they meet, mm; within bounds that are
// choices.
double reach_from(const HapticSettings& settings, double contact_stiffness) {
    constexpr double least = 0.2, most = 2;
    return std::clamp(settings.max_force / contact_stiffness, least, most);
}

collision::SurfaceFeatures features_of_tool(const Case& patient_case) {
    const TriangleMesh surface = tool_surface(patient_case, ConeContact::most_triangles);
    return {surface.vertices, surface.triangles};
}

}  // namespace

ConeContact::ConeContact(const Case& patient_case, const ContactBodies& bodies, std::size_t tool_count)
    : WholeToolContact(bodies, whole_tool_settings(patient_case, "cones"), tool_count),
      reach_(reach_from(patient_case.haptics, settings_.contact_stiffness)),
      tool_(features_of_tool(patient_case)),
      tool_tree_(tool_) {
    for (const RigidBody& body : patient_case.rigid_bodies)
        features_.emplace_back(body.surface.vertices, body.surface.triangles);
    for (const collision::SurfaceFeatures& features : features_) trees_.emplace_back(features);
    for (std::size_t t = 0; t < tool_count; ++t) watches_.emplace_back(tool_tree_, trees_, reach_);
}

ConeContact::~ConeContact() = default;

std::unique_ptr<ContactMethod> make_cones(const Case& patient_case, const ContactBodies& bodies,
                                          std::size_t tool_count) {
    return std::make_unique<ConeContact>(patient_case, bodies, tool_count);
}

}  // namespace palpate::haptics
