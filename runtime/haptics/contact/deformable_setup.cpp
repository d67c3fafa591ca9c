// SPDX-License-Identifier: Apache-2.0
// What a deformable body's contact allocates before the first tick.
#include <Eigen/Geometry>

#include "runtime/haptics/contact/compliance_blocks.hpp"
#include "runtime/haptics/contact/deformable_contact.hpp"

namespace palpate::haptics {

using Eigen::Vector3f;

DeformableContact::DeformableContact(const DeformableBody& body, std::int32_t body_index)
    : body_index_(body_index), compliance_(body.compliance), triangles_(body.boundary.surface.triangles) {
    blocks_ = compliance_blocks(body);
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

}  // namespace palpate::haptics
