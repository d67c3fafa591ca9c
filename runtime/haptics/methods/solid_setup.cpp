// SPDX-License-Identifier: Apache-2.0
// What a whole tool's triangles against those of rigid bodies are made of.
#include "runtime/collision/features/split_edges.hpp"
#include "runtime/haptics/methods/solid_contact.hpp"

namespace palpate::haptics {
namespace {

collision::SurfaceFeatures tool_features(const Case& patient_case) {
    const TriangleMesh surface = tool_surface(patient_case, SolidContact::most_triangles);
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
