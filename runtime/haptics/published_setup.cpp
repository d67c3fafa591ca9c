// SPDX-License-Identifier: Apache-2.0
// What the published contact allocates before the first tick.
#include <algorithm>

#include "runtime/haptics/published_contact.hpp"

namespace palpate {
namespace {

std::vector<std::int32_t> blocks_of_vertices(const DeformableBody& body) {
    std::vector<std::int32_t> blocks;
    for (const std::int32_t node : body.boundary.nodes) {
        const auto found = std::ranges::lower_bound(body.contact_nodes, node);
        const bool free = found != body.contact_nodes.end() && *found == node;
        blocks.push_back(free ? static_cast<std::int32_t>(found - body.contact_nodes.begin()) : -1);
    }
    return blocks;
}

}  // namespace

PublishedContact::PublishedContact(const Case& patient_case,
                                   std::span<const std::unique_ptr<CollisionSurface>> surfaces,
                                   ContactScheme scheme)
    : surfaces_(surfaces),
      twice_(scheme == ContactScheme::twice),
      detections_(std::vector<Detection>(surfaces.size())),
      contacted_(surfaces.size()) {
    for (const RigidBody& body : patient_case.rigid_bodies) triangles_.push_back(body.surface.triangles);
    for (const DeformableBody& body : patient_case.deformable_bodies) {
        triangles_.push_back(body.boundary.surface.triangles);
        elastic_.push_back({body.compliance, blocks_of_vertices(body)});
    }
}

void PublishedContact::reset() noexcept {
    device_.write(std::nullopt);
    std::ranges::fill(detections_.back(), Detection{});
    detections_.publish();
    std::ranges::fill(contacted_, Contacted{});
    last_device_.reset();
}

}  // namespace palpate
