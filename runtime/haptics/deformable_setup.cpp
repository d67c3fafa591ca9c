// SPDX-License-Identifier: Apache-2.0
// What a deformable body's contact allocates before the first tick.
#include <Eigen/Geometry>
#include <algorithm>

#include "formats/model/errors.hpp"
#include "runtime/haptics/deformable_contact.hpp"

namespace palpate {

using Eigen::Vector3f;

DeformableContact::DeformableContact(const DeformableBody& body, std::int32_t body_index)
    : body_index_(body_index), compliance_(body.compliance), triangles_(body.boundary.surface.triangles) {
    if (static_cast<std::size_t>(node_count(compliance_)) != body.contact_nodes.size())
        throw InvalidInput(
            {.culprit = body.name,
             .found = "its compliance has " + std::to_string(node_count(compliance_)) + " nodes",
             .expected = std::to_string(body.contact_nodes.size()),
             .next_step = "condense it again with 'palpate condense'"});
    for (const std::int32_t node : body.boundary.nodes) {
        const auto found = std::ranges::lower_bound(body.contact_nodes, node);
        const bool free = found != body.contact_nodes.end() && *found == node;
        blocks_.push_back(free ? static_cast<std::int32_t>(found - body.contact_nodes.begin()) : -1);
    }
    for (const Eigen::Vector3d& vertex : body.boundary.surface.vertices)
        vertices_.push_back(vertex.cast<float>());
    vertex_normals_.assign(vertices_.size(), Vector3f::Zero());
    for (const Triangle& t : triangles_) {
        const auto at = [&](std::size_t corner) { return static_cast<std::size_t>(t[corner]); };
        const Vector3f area =
            (vertices_[at(1)] - vertices_[at(0)]).cross(vertices_[at(2)] - vertices_[at(0)]);
        for (std::size_t corner = 0; corner < 3; ++corner) vertex_normals_[at(corner)] += area;
    }
}

}  // namespace palpate
