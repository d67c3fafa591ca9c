// SPDX-License-Identifier: Apache-2.0
// What the published contact allocates before the first tick.
#include <algorithm>
#include <cassert>

#include "runtime/haptics/contact/compliance_blocks.hpp"
#include "runtime/haptics/contact/published_contact.hpp"

namespace palpate {

PublishedContact::PublishedContact(const Case& patient_case,
                                   std::span<const std::unique_ptr<CollisionSurface>> surfaces,
                                   ContactScheme scheme)
    : surfaces_(surfaces),
      twice_(scheme == ContactScheme::twice),
      detections_(Answered{std::vector<Detection>(surfaces.size()), 0}),
      contacted_(surfaces.size()) {
    assert(scheme == ContactScheme::single || scheme == ContactScheme::twice);
    for (const RigidBody& body : patient_case.rigid_bodies) triangles_.push_back(body.surface.triangles);
    for (const DeformableBody& body : patient_case.deformable_bodies) {
        triangles_.push_back(body.boundary.surface.triangles);
        elastic_.push_back({body.compliance, compliance_blocks(body)});
    }
}

void PublishedContact::reset() noexcept {
    device_.write(std::nullopt);
    std::ranges::fill(detections_.back().bodies, Detection{});
    detections_.publish();
    std::ranges::fill(contacted_, Contacted{});
    last_device_.reset();
    ticks_undetected_ = 0;
}

}  // namespace palpate
