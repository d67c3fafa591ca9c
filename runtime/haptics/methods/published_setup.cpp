// SPDX-License-Identifier: Apache-2.0
// What the published contact allocates before the first tick.
#include <algorithm>

#include "runtime/haptics/contact/compliance_blocks.hpp"
#include "runtime/haptics/methods/published_contact.hpp"

namespace palpate::haptics {

PublishedContact::PublishedContact(const Case& patient_case, const ContactBodies& bodies, Tested tested)
    : bodies_(bodies),
      twice_(tested == Tested::twice),
      detections_(Answered{std::vector<Detection>(bodies.surfaces.size()), 0}),
      contacted_(bodies.surfaces.size()) {
    for (const DeformableBody& body : patient_case.deformable_bodies)
        elastic_.push_back({body.compliance, compliance_blocks(body)});
}

PublishedContact::~PublishedContact() = default;

void PublishedContact::reset() noexcept {
    device_.write(std::nullopt);
    std::ranges::fill(detections_.back().bodies, Detection{});
    detections_.publish();
    std::ranges::fill(contacted_, Contacted{});
    last_device_.reset();
    ticks_undetected_ = 0;
}

std::unique_ptr<ContactMethod> make_single(const Case& patient_case, const ContactBodies& bodies,
                                           std::size_t) {
    return std::make_unique<PublishedContact>(patient_case, bodies, PublishedContact::Tested::single);
}

std::unique_ptr<ContactMethod> make_twice(const Case& patient_case, const ContactBodies& bodies,
                                          std::size_t) {
    return std::make_unique<PublishedContact>(patient_case, bodies, PublishedContact::Tested::twice);
}

}  // namespace palpate::haptics
