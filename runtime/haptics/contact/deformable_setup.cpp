// SPDX-License-Identifier: Apache-2.0
// What a deformable body's contact allocates before the first tick.
#include <map>
#include <utility>

#include "runtime/haptics/contact/compliance_blocks.hpp"
#include "runtime/haptics/contact/deformable_contact.hpp"

namespace palpate::haptics {
namespace {

// The triangles across the edges of each; the triangle itself across an open edge.
std::vector<std::array<std::int32_t, 3>> neighbours_of(const std::vector<Triangle>& triangles) {
    std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> by_edge;
    const auto edge = [&](std::size_t t, std::size_t corner) {
        return std::pair(triangles[t][corner], triangles[t][(corner + 1) % 3]);
    };
    for (std::size_t t = 0; t < triangles.size(); ++t)
        for (std::size_t corner = 0; corner < 3; ++corner)
            by_edge.emplace(edge(t, corner), static_cast<std::int32_t>(t));
    std::vector<std::array<std::int32_t, 3>> neighbours(triangles.size());
    for (std::size_t t = 0; t < triangles.size(); ++t)
        for (std::size_t corner = 0; corner < 3; ++corner) {
            const auto [a, b] = edge(t, corner);
            const auto across = by_edge.find({b, a});
            neighbours[t][corner] = across == by_edge.end() ? static_cast<std::int32_t>(t) : across->second;
        }
    return neighbours;
}

}  // namespace

using Eigen::Vector3f;

DeformableContact::DeformableContact(const DeformableBody& body, std::int32_t body_index, bool spreads_load)
    : body_index_(body_index), compliance_(body.compliance), triangles_(body.boundary.surface.triangles) {
    blocks_ = compliance_blocks(body);
    neighbours_ = neighbours_of(triangles_);
    if (spreads_load) spread_.emplace(body, blocks_);
    for (const Eigen::Vector3d& vertex : body.boundary.surface.vertices)
        vertices_.push_back(vertex.cast<float>());
}

}  // namespace palpate::haptics
