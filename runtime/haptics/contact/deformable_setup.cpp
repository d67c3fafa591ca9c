// SPDX-License-Identifier: Apache-2.0
// What a deformable body's contact allocates before the first tick.
#include "formats/model/contact/compliance_blocks.hpp"
#include "runtime/haptics/contact/deformable_contact.hpp"
#include "runtime/haptics/contact/triangle_neighbours.hpp"

namespace palpate::haptics {
using Eigen::Vector3f;

DeformableContact::DeformableContact(const DeformableBody& body, const collision::CollisionSurface& surface,
                                     double tool_radius, std::int32_t body_index, bool spreads_load)
    : body_index_(body_index), compliance_(body.compliance), triangles_(body.boundary.surface.triangles) {
    blocks_ = compliance_blocks(body);
    neighbours_ = triangle_neighbours(triangles_);
    if (spreads_load) {
        spread_.emplace(body, blocks_);
        inner_balls_ = inner_balls(body.boundary.surface, surface, blocks_, tool_radius);
    }
    for (const Eigen::Vector3d& vertex : body.boundary.surface.vertices)
        vertices_.push_back(vertex.cast<float>());
    SurfaceCreepSeries creep = surface_creep_of(body);
    for (const std::vector<CreepTerm>& series : creep.series) creep_.emplace_back(series, tick_period);
    creep_of_vertex_ = std::move(creep.of_vertex);
}

}  // namespace palpate::haptics
