// SPDX-License-Identifier: Apache-2.0
// What the published contact allocates before the first tick.
#include "formats/model/contact/compliance_blocks.hpp"
#include "runtime/haptics/methods/published_contact.hpp"

namespace palpate::haptics {

PublishedContact::PublishedContact(const Case& patient_case, const ContactBodies& bodies, Tested tested,
                                   Face face)
    : bodies_(bodies),
      twice_(tested == Tested::twice),
      renewed_(face == Face::renewed),
      detections_(Answered{std::vector<Detection>(bodies.surfaces.size())}),
      contacted_(bodies.surfaces.size()) {
    for (const DeformableBody& body : patient_case.deformable_bodies)
        elastic_.push_back({body.compliance, compliance_blocks(body)});
}

PublishedContact::~PublishedContact() = default;

void PublishedContact::reset() noexcept {
    lose();
}

}  // namespace palpate::haptics
