// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cassert>
#include <span>

#include "formats/records/tick_result.hpp"

namespace palpate::openigtlink {

/// Computes where a contact is (p_P, mm): the weighted sum of its vertices. With a body's rest vertices it is
/// the point at rest; with displaced ones (rest + HapticModel::surface_displacement) where it is now.
/// `vertices`: of the surface of body contact.body, all of them (indices asserted).
inline Eigen::Vector3d contact_point(const Contact& contact,
                                     std::span<const Eigen::Vector3d> vertices) noexcept {
    Eigen::Vector3d point = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < contact.vertices.size(); ++i)
        if (contact.vertices[i] >= 0) {
            assert(contact.vertices[i] < std::ssize(vertices));
            point += static_cast<double>(contact.weights[i]) * vertices[contact.vertices[i]];
        }
    return point;
}

}  // namespace palpate::openigtlink
