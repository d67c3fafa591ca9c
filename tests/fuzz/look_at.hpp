// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "formats/model/body.hpp"

namespace palpate::fuzz {

/// Looks at all of a body's compliance, as the runtime may: what a reader lets pass must hold for it.
inline void look_at(const DeformableBody& body) {
    const std::int32_t nodes = node_count(body.compliance);
    std::vector<Eigen::Vector3f> moved(static_cast<std::size_t>(nodes), Eigen::Vector3f::Zero());
    std::vector<NodeForce> forces;
    for (std::int32_t node = 0; node < nodes; ++node) {
        forces.push_back({node, {1, 2, 3}});
        compliance_block(body.compliance, node, nodes - 1 - node);
    }
    add_displacements(body.compliance, forces, moved);
}

/// Looks at compliances and scan of a case.
inline void look_at(const Case& patient_case) {
    if (const auto& scan = patient_case.scan)
        scan->grid.index_of(
            scan->grid.point_of(Eigen::Vector3d::Zero()));  // asserts an orthonormal direction
    for (const DeformableBody& body : patient_case.deformable_bodies) look_at(body);
}

}  // namespace palpate::fuzz
