// SPDX-License-Identifier: Apache-2.0
// What the search for an equilibrium allocates before the first tick.
#include "runtime/haptics/contact/equilibrium/contact_equilibrium.hpp"

namespace palpate::haptics {

DeformedPatch::DeformedPatch(const DeformableContact& body)
    : body_(&body),
      slots_(body.vertex_count(), no_slot),
      vertices_(most_vertices),
      rest_(most_vertices),
      moved_(most_vertices),
      before_(most_vertices),
      held_moved_(most_vertices),
      seen_(most_vertices),
      sum_(most_vertices),
      blocks_(static_cast<std::size_t>(most_vertices * most_vertices)),
      forces_(most_vertices),
      held_(most_vertices),
      answers_(iterates, Answer(most_vertices)),
      leans_(most_vertices, Eigen::Vector3d::Zero()),
      leant_(most_vertices, Eigen::Vector3d::Zero()),
      creeps_as_(most_vertices),
      left_forces_(most_vertices),
      left_moves_(most_vertices),
      lasting_(most_vertices, Eigen::Vector3d::Zero()) {}

ContactEquilibrium::ContactEquilibrium(const ContactBodies& bodies, double radius, const Friction& friction,
                                       std::size_t tool_count, std::size_t spheres)
    : bodies_(bodies), radius_(radius), friction_(friction), neighbours_(bodies) {
    for (const DeformableContact& body : bodies.deformable) {
        patches_.emplace_back(body);
        visited_.emplace_back(body.triangle_count(), 0U);
    }
    Tool tool;
    tool.parts.resize(spheres);
    for (Part& part : tool.parts) part.touches.resize(patches_.size());
    tools_.assign(tool_count, tool);
}

ContactEquilibrium::~ContactEquilibrium() = default;

}  // namespace palpate::haptics
