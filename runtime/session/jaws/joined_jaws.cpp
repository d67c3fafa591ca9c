// SPDX-License-Identifier: Apache-2.0
#include "runtime/session/jaws/joined_jaws.hpp"

#include <algorithm>

#include "formats/model/arrays.hpp"

namespace palpate::session {
namespace {

using Vector = std::array<double, 3>;

Vector halfway(const Vector& a, const Vector& b) {
    return array_of(Eigen::Vector3d((vector_of(a) + vector_of(b)) / 2));
}

}  // namespace

TickResult joined_jaws(const TickResult& first, const TickResult& second) {
    TickResult joined;
    copy_active(first, joined);
    joined.device_position = halfway(first.device_position, second.device_position);
    joined.tool_position = halfway(first.tool_position, second.tool_position);
    joined.force = array_of(Eigen::Vector3d(vector_of(first.force) + vector_of(second.force)));
    if (second.depth > first.depth) {
        joined.depth = second.depth;
        joined.body = second.body;
    }
    joined.status |= second.status;
    joined.faults |= second.faults;
    for (const Contact& contact : second.active_contacts())
        if (const auto used = static_cast<std::size_t>(joined.contact_count); used < max_contacts) {
            joined.contacts[used] = contact;
            ++joined.contact_count;
        }
    return joined;
}

}  // namespace palpate::session
