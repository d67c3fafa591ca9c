// SPDX-License-Identifier: Apache-2.0
// What a whole tool's triangles against those of rigid bodies are made of.
#include "formats/model/errors.hpp"
#include "runtime/collision/features/split_edges.hpp"
#include "runtime/haptics/methods/solid_contact.hpp"
#include "runtime/haptics/whole_tool/rod.hpp"

namespace palpate::haptics {
namespace {

collision::SurfaceFeatures tool_features(const Case& patient_case) {
    const TriangleMesh surface = has_instrument(patient_case) ? patient_case.tool->surface
                                                              : rod_surface(patient_case.haptics.tool_radius,
                                                                            rod_length(patient_case));
    if (surface.triangles.size() > SolidContact::most_triangles)
        throw InvalidInput({"instrument", std::to_string(surface.triangles.size()) + " triangles",
                            std::to_string(SolidContact::most_triangles) + " or fewer",
                            "simplify its surface, or use contact method 'shell'"});
    const TriangleMesh split =
        collision::split_long_edges(surface, SolidContact::longest_edge, SolidContact::most_triangles);
    return {split.vertices, split.triangles};
}

collision::SurfaceFeatures features_of(const RigidBody& body, const collision::CollisionSurface& surface) {
    std::vector<Triangle> slots;
    for (std::int32_t slot = 0; slot < surface.triangle_count(); ++slot)
        slots.push_back(body.surface.triangles[static_cast<std::size_t>(surface.mesh_triangle(slot))]);
    return {body.surface.vertices, slots};
}

}  // namespace

SolidContact::SolidContact(const Case& patient_case, const ContactBodies& bodies, std::size_t tool_count)
    : WholeToolContact(bodies, whole_tool_settings(patient_case, "solid"), tool_count),
      surface_(tool_features(patient_case)) {
    for (std::size_t body = 0; body < bodies.rigid_count(); ++body)
        features_.push_back(features_of(patient_case.rigid_bodies[body], *bodies.surfaces[body]));
    for (std::size_t body = 0; body < bodies.rigid_count(); ++body)
        solids_.push_back({bodies.surfaces[body].get(), &features_[body]});
    for (std::size_t t = 0; t < tool_count; ++t) watches_.emplace_back(surface_, solids_);
}

SolidContact::~SolidContact() = default;

std::unique_ptr<ContactMethod> make_solid(const Case& patient_case, const ContactBodies& bodies,
                                          std::size_t tool_count) {
    return std::make_unique<SolidContact>(patient_case, bodies, tool_count);
}

}  // namespace palpate::haptics
