// SPDX-License-Identifier: Apache-2.0
#include "runtime/haptics/contact/contact_bodies.hpp"

namespace palpate::haptics {

using namespace collision;

ContactBodies::ContactBodies(const Case& patient_case, bool spreads_loads) {
    for (const RigidBody& body : patient_case.rigid_bodies) {
        names.push_back(body.name);
        surfaces.push_back(std::make_unique<CollisionSurface>(body.surface, body.obb_tree, body.name));
        triangles.push_back(body.surface.triangles);
    }
    for (const DeformableBody& body : patient_case.deformable_bodies) {
        const auto index = static_cast<std::int32_t>(names.size());
        names.push_back(body.name);
        surfaces.push_back(
            std::make_unique<CollisionSurface>(body.boundary.surface, body.obb_tree, body.name));
        triangles.push_back(body.boundary.surface.triangles);
        deformable.emplace_back(body, *surfaces.back(), patient_case.haptics.tool_radius, index,
                                spreads_loads);
    }
}

}  // namespace palpate::haptics
