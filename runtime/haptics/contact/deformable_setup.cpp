// SPDX-License-Identifier: Apache-2.0
// What a deformable body's contact allocates before the first tick.
#include <algorithm>

#include "formats/model/contact/compliance_blocks.hpp"
#include "runtime/haptics/contact/deformable_contact.hpp"
#include "runtime/haptics/contact/triangle_neighbours.hpp"

namespace palpate::haptics {
using Eigen::Vector3f;

constexpr double period = 1e-3;  // s

DeformableContact::DeformableContact(const DeformableBody& body, std::vector<InnerBall> inner_balls,
                                     std::int32_t body_index, bool spreads_load)
    : body_index_(body_index),
      compliance_(body.compliance),
      triangles_(body.boundary.surface.triangles),
      inner_balls_(std::move(inner_balls)) {
    blocks_ = compliance_blocks(body);
    for (const InnerBall& ball : inner_balls_)
        most_cut_off_ = std::max(most_cut_off_, ball.inset.norm() - ball.radius);
    neighbours_ = triangle_neighbours(triangles_);
    if (spreads_load) spread_.emplace(body, blocks_);
    for (const Eigen::Vector3d& vertex : body.boundary.surface.vertices)
        vertices_.push_back(vertex.cast<float>());
    SurfaceCreepSeries creep = surface_creep_of(body);
    for (const std::vector<CreepTerm>& series : creep.series) creep_.emplace_back(series, period);
    creep_of_vertex_ = std::move(creep.of_vertex);
}

}  // namespace palpate::haptics
